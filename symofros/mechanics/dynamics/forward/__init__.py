"""Forward dynamics of trees: by the factors of M, or by articulated bodies."""
