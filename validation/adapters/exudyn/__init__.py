"""Exudyn: loops, beams, its own solvers (github.com/jgerstm/EXUDYN)."""

from validation.contract.conventions import Difference

DIFFERENCES: tuple[Difference, ...] = ()
