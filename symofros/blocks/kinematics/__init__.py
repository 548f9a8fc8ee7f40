"""Kinematics, direct and inverse (section 6.1 of the paper)."""
