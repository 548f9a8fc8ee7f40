"""Edits of a YAML text that keep every byte they are not about: spans, data edits, text edits."""
