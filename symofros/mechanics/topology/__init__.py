"""Description -> checked graph -> spanning tree -> coordinate indices."""
