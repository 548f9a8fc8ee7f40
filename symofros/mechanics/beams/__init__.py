"""One flexible body in its own frame: shape functions, deformation, modal integrals (docs/theory/beams.md)."""
