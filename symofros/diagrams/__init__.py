"""Diagrams: blocks, what joins them, and the C program or the interpreter that runs them."""
