"""Numbers for edges: the NumPy interpreter, extended precision, sines with the bits of the C code."""
