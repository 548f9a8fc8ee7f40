"""MJCF in: MuJoCo compiles a vetted text, its model becomes a System."""
