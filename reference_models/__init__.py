"""Models with their sources, as data."""
