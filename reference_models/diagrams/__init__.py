"""Diagrams to try blocks on, and the paper's example."""
