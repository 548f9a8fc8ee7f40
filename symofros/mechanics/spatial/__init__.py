"""Geometry and mechanics of one frame on the graph: rotations, partial velocities, wrenches, inertia."""
