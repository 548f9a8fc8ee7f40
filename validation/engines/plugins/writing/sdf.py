"""A tree as SDF 1.6, which old parsers and new ones read alike: poses in the model's frame, axes in the joint's."""

from __future__ import annotations

import numpy as np

from ...interface import Array, Link, Tree, Unsupported, rows, vector
from .urdf import numbers, rpy

_LIMIT = "<limit><lower>-100</lower><upper>100</upper><effort>1e9</effort><velocity>1e9</velocity></limit>"
_TYPES = {"revolute": "revolute", "prismatic": "prismatic", "fixed": "fixed"}


def describe(tree: Tree) -> str | Unsupported:
    """The file; links hang on one joint each, of one coordinate or none."""
    poses: list[tuple[Array, Array]] = []
    parts: list[str] = []
    for link in tree.links:
        if len(link.joints) != 1 or link.joints[0].kind not in _TYPES or link.joints[0].armature:
            return Unsupported("one joint a link, of one coordinate or none, without armature", offered=False)
        (joint,) = link.joints
        R, p = poses[link.parent] if link.parent >= 0 else (np.eye(3), np.zeros(3))
        pose = (R @ np.array(joint.R), p + R @ np.array(joint.p))
        poses.append(pose)
        parent = tree.links[link.parent].name if link.parent >= 0 else "world"
        axis = "" if joint.kind == "fixed" else f"<axis><xyz>{numbers(joint.axis)}</xyz>{_LIMIT}</axis>"
        ends = f"<parent>{parent}</parent><child>{link.name}</child>"
        parts += [
            _link(link, pose),
            f'<joint name="joint_{link.name}" type="{_TYPES[joint.kind]}">{ends}{axis}</joint>',
        ]
    return "\n".join(['<sdf version="1.6"><model name="tree">', *parts, "</model></sdf>"])


def _link(link: Link, pose: tuple[Array, Array]) -> str:
    J = link.inertia
    names = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    entries = "".join(f"<{name}>{float(J[i][j])!r}</{name}>" for name, i, j in names)
    at = f"{numbers(vector(pose[1]))} {numbers(rpy(rows(pose[0])))}"
    return (
        f'<link name="{link.name}"><pose>{at}</pose><inertial><pose>{numbers(link.com)} 0 0 0</pose>'
        f"<mass>{float(link.mass)!r}</mass><inertia>{entries}</inertia></inertial></link>"
    )
