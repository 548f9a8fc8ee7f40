"""Kernels on a graphics processor: beside C, and rollouts beside MuJoCo Warp (`python -m validation cuda`)."""
