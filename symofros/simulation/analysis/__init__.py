"""States and small motions: assembly, equilibria, modes, linear models, inverse kinematics, base parameters."""
