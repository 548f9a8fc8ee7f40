"""Runs of diagrams, compiled and interpreted, and what they record."""
