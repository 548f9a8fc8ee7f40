"""The woodpecker toy, as a system with rigid contacts and by equations of its own, integrated by SciPy.

A sleeve with play on a vertical rod carries, by a torsion spring, a bird that swings and pecks at the rod. Numbers:
Ch. Glocker, Dynamik von Starrkoerpersystemen mit Reibung und Stoessen, dissertation, TU Muenchen 1995, p. 162;
R. I. Leine, Ch. Glocker, D. H. van Campen, Nonlinear Dynamics of the Woodpecker Toy, Proc. DETC 2001, VIB-21608. There
gaps are linear in the angles, and coefficients of restitution are Newton's or Poisson's; here bodies turn by finite
angles, and that of the beak is Stronge's.
"""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

import symofros as sf

G = 9.81
SLEEVE, BIRD = (3e-4, 5e-9), (4.5e-3, 7e-7)  # Mass [kg], moment of inertia [kg m^2].
ROD, BORE, HALF = 2.5e-3, 3.1e-3, 5.8e-3  # Radii of rod and bore, half the sleeve's height [m].
TO_SPRING, TO_BIRD = 1.0e-2, 1.5e-2  # From the sleeve's centre to the spring, from there to the bird's [m].
BEAK = (-2.01e-2, 2.0e-2)  # From the bird's centre [m].
STIFFNESS, FRICTION = 5.6e-3, 0.3  # [N m/rad], [1].
RESTITUTION = {"beak": 0.5, "lower": 0.0, "upper": 0.0}
_STILL = 1e-9  # Speed that is none [m/s].


def system() -> sf.System:
    """The toy: height, angle of the sleeve, angle of the bird against it."""
    side = sf.Frame("side", (ROD, 0, 0), sf.Rotation.axis_angle((0, 1, 0), pi / 2))  # Its z axis is the world's x.
    (m, J), (m_bird, J_bird), turn = SLEEVE, BIRD, (0, -1, 0)
    on_slide = sf.Joint("sleeve", "revolute", axis=turn, parent="slide")
    hinge = sf.Joint(
        "bird", "revolute", axis=turn, parent="sleeve", position=(TO_SPRING, 0, 0), elements=[sf.Spring(STIFFNESS)]
    )
    bodies = [
        sf.RigidBody("rod", frames=[side]),
        sf.RigidBody("slide", sf.Joint("height", "prismatic", axis=(0, 0, 1))),
        sf.RigidBody("sleeve", on_slide, sf.Inertia(m, moments=(J,) * 3)),
        sf.RigidBody("bird", hinge, sf.Inertia(m_bird, (TO_BIRD, 0, 0), moments=(J_bird,) * 3)),
    ]
    places = {
        "beak": ("bird", (TO_BIRD + BEAK[0], 0, BEAK[1])),
        "lower": ("sleeve", (BORE, 0, -HALF)),
        "upper": ("sleeve", (BORE, 0, HALF)),
    }
    surface = ("rod", "side")
    contacts = [
        sf.Contact(name, (body, None), surface, restitution=RESTITUTION[name], friction=FRICTION, points=[point])
        for name, (body, point) in places.items()
    ]
    return sf.System("woodpecker", bodies, connections=contacts)


def _arm(a: float, b: float, angle: float, rate: float) -> tuple[Any, Any, Any]:
    """Place (x, z) of a point (a, b) of what has turned, its derivative by the angle, its acceleration by the rate."""
    c, s = cos(angle), sin(angle)
    place = np.array([a * c - b * s, a * s + b * c])
    return place, np.array([-place[1], place[0]]), -place * rate**2


def _point(x: Any, a: float, b: float, on_bird: bool) -> tuple[float, Any, Any]:
    """x, J (2 x 3) and J' v of a point of the sleeve, or of the bird from its spring, at a state as of `integrate`."""
    J = np.zeros((2, 3))
    J[1, 0] = 1.0
    if not on_bird:
        place, J[:, 1], bias = _arm(a, b, x[1], x[4])
        return place[0], J, bias
    place, J[:, 1], bias = _arm(TO_SPRING, 0.0, x[1], x[4])
    further, J[:, 2], more = _arm(a, b, x[2], x[5])
    return place[0] + further[0], J, bias + more


_POINTS = {"beak": (TO_BIRD + BEAK[0], BEAK[1], True), "lower": (BORE, -HALF, False), "upper": (BORE, HALF, False)}
NAMES = tuple(_POINTS)


class _Modes(NamedTuple):
    """Modes of the three contacts, 0 open, 1 and -1 sliding up and down, 2 sticking, and what follows from them."""

    a: Any
    normal: Any
    across: Any  # Friction.
    leaves: Any  # Accelerations (3 x 2) of the points: away from the rod, along it.


def _motion(x: Any, modes: tuple[int, ...]) -> _Modes:
    """Accelerations and forces in given modes."""
    _, J, bias = _point(x, TO_BIRD, 0.0, True)
    M = np.diag([SLEEVE[0], SLEEVE[1], BIRD[1]]) + BIRD[0] * J.T @ J
    twist = STIFFNESS * (x[2] - x[1])
    force = np.array([-SLEEVE[0] * G, twist, -twist]) - BIRD[0] * J.T @ (bias + np.array([0.0, G]))
    points = [_point(x, *_POINTS[name]) for name in NAMES]
    A, y = np.zeros((9, 9)), np.zeros(9)
    A[:3, :3], y[:3] = M, force
    for k, (mode, (_, rows, drift)) in enumerate(zip(modes, points, strict=True)):
        n, t = 3 + k, 6 + k
        A[:3, n], A[:3, t] = -rows[0], -rows[1]
        A[n, n] = A[t, t] = 1.0
        if mode:
            A[n] = [*rows[0], *np.zeros(6)]
            y[n] = -drift[0]
            A[t, n] = FRICTION * mode  # Friction against the slip.
        if mode == 2:
            A[t] = [*rows[1], *np.zeros(6)]
            y[t] = -drift[1]
    solved = np.linalg.solve(A, y)
    leaves = np.array([rows @ solved[:3] + drift for _, rows, drift in points])
    return _Modes(solved[:3], solved[3:6], solved[6:9], leaves)


def _choose(x: Any, touching: list[int]) -> tuple[int, ...]:
    """Modes by Coulomb's law at an instant after impacts, those with more contact first."""
    velocity = {k: _point(x, *_POINTS[NAMES[k]])[1] @ x[3:] for k in touching}
    choices: list[tuple[int, ...]] = [(0,)] * 3
    for k, u in velocity.items():
        if u[0] <= _STILL:
            choices[k] = (2, 1, -1, 0) if abs(u[1]) < _STILL else (int(np.sign(u[1])), 0)
    for modes in product(*choices):
        found = _motion(x, modes)
        right = True
        for k, mode in enumerate(modes):
            away, along = found.leaves[k]
            if mode == 0:
                right &= k not in velocity or velocity[k][0] > _STILL or away >= -1e-9
            else:
                right &= found.normal[k] > 1e-9
                right &= mode != 2 or abs(found.across[k]) < FRICTION * found.normal[k] * (1 - 1e-9)
                right &= mode == 2 or len(choices[k]) < 3 or mode * along >= -1e-6
        if right:
            return modes
    raise AssertionError("no modes")


def _impulse(W: Any, u: Any, e: float) -> Any:
    """Impulse (away, along) on a point by Coulomb's law along the normal impulse, and Stronge's coefficient."""
    P, work, target = np.zeros(2), 0.0, None
    u = np.array(u)
    for _ in range(20):
        slides = abs(u[1]) > _STILL
        ratio = -W[1, 0] / W[1, 1]
        h = -FRICTION * np.sign(u[1]) if slides else ratio if abs(ratio) <= FRICTION else FRICTION * np.sign(ratio)
        rate = W @ [1.0, h]
        stops = -u[1] / rate[1] if slides and u[1] * rate[1] < 0 else np.inf
        if target is None:
            end = -u[0] / rate[0]
        else:
            end = (-u[0] + sqrt(u[0] ** 2 + 2 * rate[0] * (target - work))) / rate[0]
        dp = min(end, stops)
        work += u[0] * dp + rate[0] * dp**2 / 2
        u, P = u + rate * dp, P + np.array([1.0, h]) * dp
        if stops < end:
            u[1] = 0.0
        elif target is None and e > 0:
            target, work, u[0] = -(e**2) * work, 0.0, 0.0
        else:
            return P
    raise AssertionError("no end of the impact")


def _strike(x: Any, touching: list[int], modes: tuple[int, ...]) -> Any:
    """Speeds after impacts one after the other, the fastest first."""
    x = x.copy()
    _, J, _ = _point(x, TO_BIRD, 0.0, True)
    inverse = np.linalg.inv(np.diag([SLEEVE[0], SLEEVE[1], BIRD[1]]) + BIRD[0] * J.T @ J)
    rows = {k: _point(x, *_POINTS[NAMES[k]])[1] for k in touching}
    while touching:
        k = min(touching, key=lambda k: (rows[k] @ x[3:])[0])
        u = rows[k] @ x[3:]
        if u[0] >= -_STILL:
            return x
        e = RESTITUTION[NAMES[k]] if modes[k] == 0 else 0.0
        x[3:] += inverse @ rows[k].T @ _impulse(rows[k] @ inverse @ rows[k].T, u, e)
    return x


def _watched(k: int, part: int, modes: tuple[int, ...]) -> Any:
    """What falls to zero where the mode of a contact ends: gap or normal force; slip, or what friction has left."""

    def value(t: float, x: Any) -> float:
        place, J, _ = _point(x, *_POINTS[NAMES[k]])
        if modes[k] == 0:
            return place - ROD if part == 0 else 1.0
        if part == 1 and modes[k] != 2:
            return float(modes[k] * (J @ x[3:])[1]) + 1e-14
        at = _motion(x, modes)
        return float(at.normal[k] if part == 0 else FRICTION * at.normal[k] - abs(at.across[k]))

    value.terminal, value.direction = True, -1  # type: ignore[attr-defined]
    return value


def integrate(x: Any, t_end: float) -> list[tuple[float, str, tuple[int, ...], Any]]:
    """Instants at which a mode ends, its contact, the modes of all that follow, and the state then.

    Args:
        x: Height, angles of sleeve and bird against the world, and their rates.
        t_end: Where it ends [s].
    """
    modes: tuple[int, ...] = (0, 0, 0)
    t, x = 0.0, np.array(x, dtype=float)
    found: list[tuple[float, str, tuple[int, ...], Any]] = []
    while True:
        touching = [k for k, name in enumerate(NAMES) if modes[k] or _point(x, *_POINTS[name])[0] - ROD < 1e-11]
        x = _strike(x, touching, modes)
        modes = _choose(x, touching)
        if found:
            found[-1] = (*found[-1][:2], modes, x.copy())
        events = [_watched(k, part, modes) for k in range(3) for part in range(2)]

        def slope(t: float, x: Any, modes: tuple[int, ...] = modes) -> Any:
            return np.concatenate([x[3:], _motion(x, modes).a])

        done = solve_ivp(slope, (t, t_end), x, "DOP853", rtol=1e-11, atol=1e-14, max_step=2e-3, events=events)
        if done.status != 1:
            return found
        t, x = float(done.t[-1]), done.y[:, -1]
        which = next(k for k, at in enumerate(done.t_events) if len(at))
        found.append((t, NAMES[which // 2], modes, x))
