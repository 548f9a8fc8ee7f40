"""Geometrically exact beams by their strains, rods (docs/theory/rods.md)."""
