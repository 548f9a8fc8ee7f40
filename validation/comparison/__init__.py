"""Whom an engine is compared with, by what errors, and what follows from motions, loops and orders of truncation."""
