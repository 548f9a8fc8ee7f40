"""Controllers (section 6.1 of the paper)."""
