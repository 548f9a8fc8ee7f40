"""Applied forces: generalized forces of elements, loads, connections, potentials and beams."""
