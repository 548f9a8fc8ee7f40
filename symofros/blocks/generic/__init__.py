"""Generic blocks: signals, sampling, limits, linear systems, orientations, formulas."""
