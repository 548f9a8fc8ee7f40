"""Red cells: shrunk, written as scripts, run."""
