"""Beams: stiffness against the step, spin, large deflections, families of shape functions."""
