"""One script per stage, from the file of the stage before to its own."""
