"""Orbits, guidance, spacecraft and their tanks in many digits."""
