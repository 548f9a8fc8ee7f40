"""Methods of `Model` by subject."""
