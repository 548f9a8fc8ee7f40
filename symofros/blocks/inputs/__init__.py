"""Inputs: trajectories and signals that are known beforehand (section 6.1 of the paper)."""
