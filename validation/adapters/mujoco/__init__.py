"""MuJoCo: trees, its own readings of files, its own integrators (github.com/google-deepmind/mujoco).

Beyond the conventions that its plug-in states: a free joint has position and orientation in the world frame, and on a
moving parent is three slides along P, then a ball; frame velocities and accelerations are (angular; linear), the linear
part of the latter with -gravity. The potential energy of an MJCF file is that of everything with mass, moving or not.
"""
