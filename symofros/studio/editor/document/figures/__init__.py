"""Figures beside the fields of a window: sections, inertia, shape functions."""
