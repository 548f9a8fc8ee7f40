"""Forces that act on trees, in many digits."""
