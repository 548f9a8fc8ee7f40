"""Closed loops: drift, singular postures, redundant and soft closures."""
