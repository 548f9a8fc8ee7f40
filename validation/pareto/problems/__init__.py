"""The problems of the comparison."""
