"""Whether files describe the same mechanism, and in which entry they first differ."""
