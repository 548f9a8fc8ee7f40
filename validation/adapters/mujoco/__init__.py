"""MuJoCo: trees, its own readings of files, its own integrators (github.com/google-deepmind/mujoco)."""

from ...contract.conventions import Difference

DIFFERENCES = (
    Difference("mujoco", "quaternion", "(x, y, z, w)", "(w, x, y, z)"),
    Difference("mujoco", "free joint, position", "of the body origin in the proximal frame P", "in the world frame"),
    Difference("mujoco", "free joint, orientation", "R_PB", "R_WB"),
    Difference("mujoco", "free joint, linear speed v", "in body axes", "in world axes: v_e = R_WB v"),
    Difference("mujoco", "free joint, linear acceleration", "dv/dt of the body components", "R_WB (dv/dt + w x v)"),
    Difference("mujoco", "free joint on a moving parent", "one joint", "three slides along P, then a ball joint"),
    Difference("mujoco", "frame velocity and acceleration", "(linear; angular)", "(angular; linear)"),
    Difference("mujoco", "frame acceleration", "d/dt of the frame velocity", "with -gravity added to the linear part"),
    Difference("mujoco-urdf", "angles in the model", "radians", "degrees, unless the compiler's option says otherwise"),
    Difference("mujoco-mjcf", "potential energy", "of what moves", "of everything with mass, moving or not"),
)
