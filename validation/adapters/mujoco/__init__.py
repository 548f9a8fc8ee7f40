"""MuJoCo: trees, its own readings of files, its own integrators (github.com/google-deepmind/mujoco)."""
