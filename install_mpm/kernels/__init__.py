"""Compiled loops over cells and points: no I/O, no allocation of state, no validation."""
