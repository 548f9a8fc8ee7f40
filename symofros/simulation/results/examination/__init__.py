"""What is looked at after a run: its steps, inputs, constraints and energy, and what follows for its outcome."""
