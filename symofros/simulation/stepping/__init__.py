"""The stepping loops in C, driven from Python: methods, steppers, batches, SUNDIALS."""
