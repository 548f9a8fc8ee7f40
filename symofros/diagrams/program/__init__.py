"""From wired blocks to the functions and the layout of one compiled program."""
