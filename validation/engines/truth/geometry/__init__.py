"""Rotations, placements, lines, curves and solids in many digits."""
