"""Open chains of rigid bodies: energy, Euler angles, masses far apart, friction."""
