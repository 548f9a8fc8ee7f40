"""The scenes of the atlas."""
