"""Descriptions for other programs: URDF, MJCF."""
