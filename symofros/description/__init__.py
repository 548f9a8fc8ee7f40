"""What the user states: frozen dataclasses, the formula parser, files in and out. No computation."""
