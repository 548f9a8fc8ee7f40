"""One kilogram on a line under a pulse of its own formula of time: its last speed is the impulse."""

from __future__ import annotations

import numpy as np

import symofros as sf

END = 10.0
# Formula of the force, and its impulse over the width.
SHAPES: dict[str, tuple[str, float]] = {
    "tent": ("max(0, 1 - abs(t - late)/width)/width", 1.0),
    "rectangle": ("(sign(t - late) - sign(t - late - width))/(2*width)", 1.0),
    "bell": ("exp(-((t - late)/width)^2)/width", float(np.sqrt(np.pi))),
}


def cart(force: str) -> sf.System:
    body = sf.RigidBody(
        "b",
        sf.Joint("x", "prismatic", axis=(1, 0, 0)),
        sf.Inertia(1.0, moments=(1, 1, 1)),
        loads=(sf.Load(force=(force, 0, 0)),),
    )
    parameters = sf.Parameter("late", 5.0), sf.Parameter("width", 1e-3)
    return sf.System("cart", (body,), parameters=parameters, gravity=(0, 0, 0))


def drawn(count: int) -> list[tuple[float, float]]:
    """Instants and widths of pulses, seeded."""
    rng = np.random.default_rng(0)
    return [(float(rng.uniform(1.0, 8.5)), float(10 ** rng.uniform(-5, -1))) for _ in range(count)]
