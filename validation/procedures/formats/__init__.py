"""Files that are read, written and exported, and differences of models."""
