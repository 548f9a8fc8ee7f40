"""How many real faults of releases a test suite sees: the harness itself, or any other."""
