"""Beams in motion: spin-up, swing, energy, damping."""
