"""How a loop is closed that a tree of links has no place for: the words of remedies."""

from __future__ import annotations

# Type of a joint -> what its closure blocks, of frames whose z lies along the axis.
_BLOCKED = {
    "revolute": "rotations=('x', 'y')",
    "continuous": "rotations=('x', 'y')",
    "prismatic": "translations=('x', 'y'), rotations=('x', 'y', 'z')",
    "fixed": "rotations=('x', 'y', 'z')",
    "ball": "",
    "universal": "rotations=('z',)",
    "planar": "translations=('z',), rotations=('x', 'y')",
}


def closing_remedy(name: str, kind: str, parent: str, child: str) -> str:
    """What to do with a joint that would give its child a second parent.

    Args:
        name: Name of the joint.
        kind: Type of the joint.
        parent: Name of its parent.
        child: Name of its child.
    """
    if kind not in _BLOCKED:
        why = "a floating joint binds nothing" if kind in ("floating", "free") else "no closure does what its type does"
        return f"drop the joint '{name}': {why}"
    ends = [f"({body!r}, '{name}_{side}')" for body, side in ((parent, "first"), (child, "second"))]
    call = ", ".join(filter(None, (repr(name), *ends, _BLOCKED[kind])))
    axis = "z across both axes" if kind == "universal" else "z along its axis"
    return (
        f"leave joint '{name}' out, and close its loop in Python by sf.Closure({call}) among the constraints of the "
        f"System, with sf.Frame on both links where the joint is, {axis}"
    )
