"""Exudyn: loops, beams, its own solvers (github.com/jgerstm/EXUDYN)."""
