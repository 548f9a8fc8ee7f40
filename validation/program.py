"""What starts the command line of this package, as its messages and reports name it."""

PROGRAM = f"python -m {__package__}"
