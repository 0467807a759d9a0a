"""Case files, the command line, and the stages joined from file to file."""
