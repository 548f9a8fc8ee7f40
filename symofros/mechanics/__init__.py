"""From a checked description to its equations of motion: topology, beams, kinematics, dynamics."""
