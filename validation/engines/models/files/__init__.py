"""Small files that each engine's own reader is asked about."""
