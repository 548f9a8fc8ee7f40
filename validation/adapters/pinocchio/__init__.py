"""Pinocchio: trees, loops, its own reading of URDF (github.com/stack-of-tasks/pinocchio).

Beyond the conventions that its plug-in states: accelerations of frames are spatial unless asked otherwise; whether the
kinetic energy counts armatures depends on the kind of joint; a hinge that closes a loop is two points. Of a URDF file
it sorts children by name, and a continuous joint has q = (cos, sin).
"""
