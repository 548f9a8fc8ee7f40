"""SAPIEN's placements, in single precision."""

from __future__ import annotations

from ..writing.source import Way

IMPORTS = ("import sapien",)
_X = "X, Y = sapien.Pose(a, q), sapien.Pose(tau, q2)\n"


def _flat(of: str) -> str:
    return f"T = ({of}).to_transformation_matrix()\nvalue = [*T[:3, 3], *T[:3, :3].flat]"


WAYS = {
    "rotation_matrix": Way(
        "Pose.to_transformation_matrix", f"{_X}value = X.to_transformation_matrix()[:3, :3].ravel()"
    ),
    "rotation_matrix:Pose": Way(
        "Pose of a matrix",
        f"{_X}value = sapien.Pose(X.to_transformation_matrix()).to_transformation_matrix()[:3, :3].ravel()",
    ),
    "rotation_of_rpy": Way("Pose.set_rpy", f"{_X}X.set_rpy(v)\nvalue = X.to_transformation_matrix()[:3, :3].ravel()"),
    # Angles of which there are two sets: it says not which one.
    "rotation_matrix:get_rpy": Way(
        "Pose.get_rpy, set_rpy", f"{_X}Y.set_rpy(X.get_rpy())\nvalue = Y.to_transformation_matrix()[:3, :3].ravel()"
    ),
    "pose_composed": Way("Pose * Pose", f"{_X}{_flat('X * Y')}"),
    "pose_unset": Way("Pose", _flat("sapien.Pose()")),
    "pose_inverse": Way("Pose.inv", f"{_X}{_flat('X.inv()')}"),
    "pose_relative": Way("Pose.inv", f"{_X}{_flat('X.inv() * Y')}"),
}
