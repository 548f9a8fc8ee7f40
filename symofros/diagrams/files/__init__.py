"""Diagrams as YAML files: kinds of blocks, reading, writing, and the schema."""
