"""Inertia of links, beams and rotors."""
