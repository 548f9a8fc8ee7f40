"""What acts: generalized forces of elements, loads, connections, potentials and beams."""
