"""Beams: the class, their segments, their sections."""
