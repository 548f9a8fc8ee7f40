"""What is done with the equations: stepping, events, projection, analyses, diagrams, against formulas of their own."""
