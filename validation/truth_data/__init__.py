"""symofros-truth: models, states and right answers to thirty digits as files, for engines in any language."""
