"""Jourdain's principle: inertia, forces, energy, and which function returns what."""
