"""One file a question, one report a file."""
