"""Pinocchio: trees, loops, its own reading of URDF (github.com/stack-of-tasks/pinocchio)."""

from ...contract.conventions import Difference

DIFFERENCES = (
    Difference("pinocchio", "frame acceleration", "d/dt of the frame velocity: classical", "spatial, unless asked"),
    Difference("pinocchio", "kinetic energy with armatures", "counts them, like M", "depends on the kind of joint"),
    Difference("pinocchio-loops", "multipliers", "forces on the second frame's body", "on the first one's"),
    Difference("pinocchio-loops", "a hinge that closes a loop", "three translations, two rotations", "two points"),
    Difference("pinocchio-urdf", "order of joints", "as in the file", "children sorted by name"),
    Difference("pinocchio-urdf", "continuous joint", "q = angle", "q = (cos, sin)"),
)
