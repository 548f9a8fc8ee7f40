"""What every layer may use: options, the table of model functions, rotations in NumPy, writing files whole."""
