"""How a run of a diagram ended, and whether its steps follow the motion."""
