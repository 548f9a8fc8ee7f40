"""How a loop is closed that a tree of links has no place for: what closures block, and the words of remedies."""

from __future__ import annotations

from symofros.description.constraints import AXES, AxisName

# Type of a joint -> translations and rotations that its closure blocks, of frames whose z lies along the axis.
BLOCKED: dict[str, tuple[tuple[AxisName, ...], tuple[AxisName, ...]]] = {
    "revolute": (AXES, ("x", "y")),
    "continuous": (AXES, ("x", "y")),
    "prismatic": (("x", "y"), AXES),
    "cylindrical": (("x", "y"), ("x", "y")),
    "planar": (("z",), ("x", "y")),
    "universal": (AXES, ("z",)),
    "ball": (AXES, ()),
    "fixed": (AXES, AXES),
}


def closing_remedy(name: str, kind: str, parent: str, child: str) -> str:
    """Remedy for a joint that would give its child a second parent: replace it by a closure, or drop it."""
    if kind not in BLOCKED:
        why = "a floating joint binds nothing" if kind in ("floating", "free") else "no closure does what its type does"
        return f"drop the joint '{name}': {why}"
    ends = [f"({body!r}, '{name}_{side}')" for body, side in ((parent, "first"), (child, "second"))]
    translations, rotations = BLOCKED[kind]
    blocked = [f"translations={translations}"] * (translations != AXES) + [f"rotations={rotations}"] * bool(rotations)
    call = ", ".join((repr(name), *ends, *blocked))
    axis = "z across both axes" if kind == "universal" else "z along its axis"
    return (
        f"leave joint '{name}' out, and close its loop in Python by sf.Closure({call}) among the constraints of the "
        f"System, with sf.Frame on both links where the joint is, {axis}"
    )
