"""Runs and steps: every method, events, batches, steps by hand, notes."""
