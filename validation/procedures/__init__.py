"""What is done with the equations: stepping, events, projection, analyses, diagrams, against formulas of their own."""

# Name of the other side of their rows: what is compared with is no engine.
ENGINE = "formulas"
