"""What is right: the meaning of coordinates, and what mechanics makes of it in many digits."""
