"""Base to tip: rotations, joints, bodies, frames."""
