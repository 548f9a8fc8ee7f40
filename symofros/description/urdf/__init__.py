"""URDF in."""
