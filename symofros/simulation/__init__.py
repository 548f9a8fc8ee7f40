"""Model -> motion: consistent initial states (docs/theory/constraints.md, section 5)."""
