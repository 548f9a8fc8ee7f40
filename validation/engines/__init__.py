"""Which engine is wrong where: engines against thirty digits of truth and against themselves, in their own conventions.

The contract of an engine's plug-in is `interface`; an engine is one file (`plugins/`, or another package's entry point
in the group `symofros.engines`).
"""
