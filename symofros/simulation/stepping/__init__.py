"""The loops in C in Python's hands: methods, steppers, batches, SUNDIALS."""
