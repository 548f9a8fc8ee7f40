"""Functional mock-up units as blocks: what a file states of itself, and its native code in a process of its own."""
