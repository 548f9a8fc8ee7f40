"""How accurate the beams are: one module a question, and the command that answers them all."""
