"""Why cells are red: causes as people stated them, a file an engine, and the cells that they explain."""
