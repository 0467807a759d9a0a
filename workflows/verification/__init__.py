"""Named reference problems, each a function of its physical parameters."""
