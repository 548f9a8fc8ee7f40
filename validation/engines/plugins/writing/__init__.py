"""Models and calls as text: Python of an engine's own names, files of URDF and SDF."""
