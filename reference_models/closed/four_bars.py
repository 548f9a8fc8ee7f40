"""N four-bars in a row, in coordinates of a tree and in those of every bar by itself."""

from __future__ import annotations

from collections.abc import Iterator

import symofros as sf

_ROD = sf.Inertia(1.0, (0.5, 0.0, 0.0), (0.0, 1.0 / 12, 1.0 / 12))


def n_four_bar(n: int) -> sf.System:
    """N windows between N + 1 cranks; all cranks turn together, but for postures where they lie along the ground.

    Source: IFToMM benchmark library of multibody problems, A02: rods of 1 kg and 1 m, weight along -z.

    Args:
        n: Windows; 2n + 1 coordinates crank0, coupler0, ..., crank<n> and 2n conditions.
    """
    axis, end = (0, -1, 0), (sf.Frame("end", (1, 0, 0)),)
    bodies, loops = [], []
    for i in range(n + 1):
        pivot = sf.Joint(f"crank{i}", "revolute", position=(i, 0, 0), axis=axis)
        bodies.append(sf.RigidBody(f"bar{i}", pivot, _ROD, end))
        if i < n:
            hinge = sf.Joint(f"coupler{i}", "revolute", f"bar{i}", "end", axis=axis)
            bodies.append(sf.RigidBody(f"link{i}", hinge, _ROD, end))
            loops.append(sf.Closure(f"loop{i}", (f"bar{i + 1}", "end"), (f"link{i}", "end"), ("x", "z")))
    return sf.System(f"four_bar{n}", tuple(bodies), constraints=tuple(loops))


def turned(n: int, angle: float) -> dict[str, float]:
    """The posture of `n_four_bar(n)` in which all cranks are at an angle [rad]: coordinates by name."""
    cranks = {f"crank{i}": angle for i in range(n + 1)}
    return cranks | {f"coupler{i}": -angle for i in range(n)}


def n_four_bar_absolute(n: int) -> sf.System:
    """The same with three coordinates a bar, those of its mass centre: every pin is a closure, 3n + 1 pins.

    Each bar floats in the plane of the world's x and y, against weight along -y; the ends are at x = -1/2 and 1/2.
    """
    rod = sf.Inertia(1.0, (0, 0, 0), (0.0, 1.0 / 12, 1.0 / 12))
    ends = (sf.Frame("root", (-0.5, 0, 0)), sf.Frame("end", (0.5, 0, 0)))
    names = [name for i in range(n + 1) for name in ([f"bar{i}", f"link{i}"] if i < n else [f"bar{i}"])]
    bars = [sf.RigidBody(name, sf.Joint(f"{name}.pose", "planar"), rod, ends) for name in names]
    feet = tuple(sf.Frame(f"foot{i}", (i, 0, 0)) for i in range(n + 1))
    pins = [sf.Closure(f"pin{k}", first, second, ("x", "y")) for k, (first, second) in enumerate(_pins(n))]
    ground = sf.RigidBody("ground", frames=feet)
    return sf.System(f"four_bar{n}_absolute", (ground, *bars), gravity=(0, -9.81, 0), constraints=tuple(pins))


def _pins(n: int) -> Iterator[tuple[tuple[str, str], tuple[str, str]]]:
    for i in range(n + 1):
        yield ("ground", f"foot{i}"), (f"bar{i}", "root")
        if i < n:
            yield (f"bar{i}", "end"), (f"link{i}", "root")
            yield (f"bar{i + 1}", "end"), (f"link{i}", "end")
