"""What single features of engines make of small mechanisms, in many digits."""
