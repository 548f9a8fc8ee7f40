"""SAPIEN's placements, in single precision."""

from __future__ import annotations

from ..writing.source import ways_of

IMPORTS = ("import sapien",)
_X = "X, Y = sapien.Pose(a, q), sapien.Pose(tau, q2)\n"


def _flat(of: str) -> str:
    return f"T = ({of}).to_transformation_matrix()\nvalue = [*T[:3, 3], *T[:3, :3].flat]"


WAYS = ways_of(f"""
== rotation_matrix | Pose.to_transformation_matrix | {_X}value = X.to_transformation_matrix()[:3, :3].ravel()
== rotation_matrix:Pose | Pose of a matrix
{_X}value = sapien.Pose(X.to_transformation_matrix()).to_transformation_matrix()[:3, :3].ravel()
== rotation_of_rpy | Pose.set_rpy | {_X}X.set_rpy(v)\nvalue = X.to_transformation_matrix()[:3, :3].ravel()
== # Angles of which there are two sets: it says not which one.
== rotation_matrix:get_rpy | Pose.get_rpy, set_rpy
{_X}Y.set_rpy(X.get_rpy())
value = Y.to_transformation_matrix()[:3, :3].ravel()
== pose_composed | Pose * Pose | {_X}{_flat("X * Y")}
== pose_unset | Pose | {_flat("sapien.Pose()")}
== pose_inverse | Pose.inv | {_X}{_flat("X.inv()")}
== pose_relative | Pose.inv | {_X}{_flat("X.inv() * Y")}
""")
