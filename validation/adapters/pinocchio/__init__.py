"""Pinocchio: trees, loops, its own reading of URDF (github.com/stack-of-tasks/pinocchio)."""
