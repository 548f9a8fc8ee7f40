"""A description as numbers, in plain NumPy: what engines' models are built from, written apart from the generator."""
