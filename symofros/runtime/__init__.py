"""Compile, cache, load, call. Knows no symbols."""
