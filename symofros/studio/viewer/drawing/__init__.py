"""What there is to draw of a mechanism: meshes, geometry of bodies and beams, and where everything is in a state."""
