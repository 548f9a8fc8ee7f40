"""A search for scenes that are answered as good, and are not: attacks, budget, shrinking, tests of what was found."""
