"""Postures: assembled, consistent with the constraints, with frames where they are wanted."""
