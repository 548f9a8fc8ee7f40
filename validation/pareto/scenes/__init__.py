"""The scenes of the comparison."""
