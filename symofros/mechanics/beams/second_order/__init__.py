"""Beams of second order in their displacements (docs/theory/beams.md)."""
