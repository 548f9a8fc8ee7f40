"""Equations of motion for people: as SymPy, LaTeX and NumPy source."""
