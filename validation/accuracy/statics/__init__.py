"""Beams at rest: large deflections, buckling, the estimate of their own error."""
