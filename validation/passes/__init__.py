"""What each pass of the generator gains: the same model with one of them left out (`python -m validation passes`)."""
