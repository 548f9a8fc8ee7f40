"""Beams against finite elements: the rate at which meshes converge, and the orders by which the two theories differ.

M and h of elements that move as our beams do are compared like any engine's, after extrapolation. What is stated beside
that (docs/theory/elements.md): that each kind of element converges at the rate that it is extrapolated by; that elastic
forces differ by the third power of the deflection, which is what our strain energy leaves out, and not at all where
the beam is a geometrically exact rod; that rotary inertia, whose spins are of second order in ours, differs by the
second.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

import symofros as sf

from ..adapters.compiled import SymofrosEngine
from ..contract.interface import States, TreeEngine
from ..mechanics.assembly import Assembly
from ..mechanics.extrapolation import Refined
from ..mechanics.geometry import Array
from .errors import Comparison, Status
from .participants import Participant
from .retained import MARGIN, scaled
from .variants import ModelVariants

RATE, STRAIN, DAMPING, ROTARY = "mesh_rate", "strain_order", "strain_damping", "rotary_order"
EXACT = "strain_forces"
ROWS = frozenset({RATE, STRAIN, EXACT, DAMPING, ROTARY})
# States of these rows: each takes every mesh by itself.
STATES = 10
# By how much the rate of the finest meshes may stay below the stated one: half a power, where the next one is two
# powers off. Measured on the reference models: 0.02 at most.
RATE_MARGIN = 0.5
# Scales of the elastic coordinates, and differences, relative to what is compared at full deflection, that may be what
# extrapolation leaves and have no power: of elastic forces, whose differences are large; of M and h, whose are small.
STRAIN_SCALES, STRAIN_RESOLVED = (0.3, 0.03), 1e-10
ROTARY_SCALES, ROTARY_RESOLVED = (1.0, 0.1), 1e-13
# Tolerance of what is equal after extrapolation.
EQUAL = 1e-8
# Powers of the deflection in what differs: forces of our strain energy; M and h of our rotary inertia.
STRAIN_POWER, ROTARY_POWER = 3, 2


class BeamElements(Protocol):
    """One beam's elements."""

    @property
    def described(self) -> sf.Beam:
        """The beam as described."""

    @property
    def q(self) -> slice:
        """Elastic coordinates among all."""

    @property
    def v(self) -> slice:
        """Elastic speeds among all."""

    @property
    def is_rod(self) -> bool:
        """Whether it is geometrically exact, so that its elastic forces are the elements' own."""

    def strain(self, q: Array) -> list[Refined]:
        """Elastic forces of the clamped beam (N, n)."""

    def damping(self, v: Array) -> Refined:
        """Forces of the clamped beam's damping (N, n)."""


def judge_elements(one: Participant, assembly: Assembly, variants: ModelVariants) -> Iterator[Comparison]:
    """The rows on rates and orders of an engine that is made of finite elements; none of another."""
    label, system = variants.subject.label, variants.subject.system
    engine: Any = one.engine
    beams: Sequence[BeamElements] = [beam for beam in getattr(engine, "elements", ()) if beam.described.modes]
    if not beams:
        return
    start = time.perf_counter()
    states = one.states[-STATES:]  # The first ones are special.
    refined: list[Refined] = engine.refined_inertia(states)
    for beam in beams:
        ours = clamped(system, beam.described.name)
        q, v = states.q[:, beam.q], states.v[:, beam.v]
        strained = beam.strain(q)
        refined += strained
        if not beam.is_rod:
            yield judge_strain(label, one.name, beam, ours, q)
        elif strained:
            yield judge_exact_strain(label, one.name, strained, ours, q)
        if beam.described.damping != 0.0:
            yield judge_damping(label, one.name, beam, ours, v)
    yield judge_rates(label, one.name, refined)
    if engine.rotary is not None:
        yield judge_rotary(label, engine.rotary, variants.untruncated, assembly, states)
    one.seconds += time.perf_counter() - start


def clamped(system: sf.System, name: str) -> sf.Model:
    """Our model of a beam by itself, held at its root, with every term of its strain energy and nothing else."""
    beam = system.body(name)
    assert isinstance(beam, sf.Beam)
    held = sf.Joint("clamp", "fixed")
    alone = replace(beam, joint=held, frames=(), loads=())
    if not beam.elastic.is_exact:
        alone = replace(alone, retain="all")
    described = sf.System(f"{name}, clamped", (alone,), system.parameters, gravity=(0.0, 0.0, 0.0))
    return sf.compile(described, sf.Options(functions=("generalized_force",)))


def judge_rates(label: str, engine: str, refined: Sequence[Refined]) -> Comparison:
    """Whether meshes converge at the rates that they are extrapolated by."""
    rates = {one.name: (rate, one) for one in refined if (rate := one.rate()) is not None}
    if not rates:
        return Comparison(label, engine, RATE, "unsupported", note="every mesh has the limit to rounding")
    name, (rate, worst) = min(rates.items(), key=lambda item: item[1][0] - item[1][1].powers[0])
    coarse, fine = worst.steps()[-2:]
    listed = ", ".join(f"{key} {value:.2f} of {one.powers[0]}" for key, (value, one) in rates.items())
    return Comparison(
        label,
        engine,
        RATE,
        "agree" if rate >= worst.powers[0] - RATE_MARGIN else "disagree",
        len(worst.values),
        fine,
        coarse * 0.5 ** (worst.powers[0] - RATE_MARGIN),
        note=f"powers of the element length by which meshes err: {listed}",
        extra={"power": rate},
    )


def judge_strain(label: str, engine: str, beam: BeamElements, ours: sf.Model, q: Array) -> Comparison:
    """Whether elastic forces differ from the elements' by the order of the terms that our strain energy omits.

    Args:
        label: Label of the model.
        engine: Name of the engine.
        beam: The beam's elements.
        ours: The same beam of ours, clamped.
        q: Elastic coordinates (N, n), which are scaled.
    """
    size = float(np.abs(_forces(ours, q)).max()) or 1.0
    at = {}
    for eps in STRAIN_SCALES:
        forces = _forces(ours, eps * q)
        at[eps] = {one.name: float(np.abs(one.limit() - forces).max()) / size for one in beam.strain(eps * q)}
    return _by_powers(Comparison(label, engine, STRAIN, "agree", len(q)), STRAIN_POWER, at, STRAIN_RESOLVED)


def judge_exact_strain(label: str, engine: str, strained: Sequence[Refined], ours: sf.Model, q: Array) -> Comparison:
    """Whether elastic forces of a rod are those of elements, whatever the deflection.

    Args:
        label: Label of the model.
        engine: Name of the engine.
        strained: The elements' elastic forces, by kinds of elements.
        ours: The same rod of ours, clamped.
        q: Strain coordinates (N, n).
    """
    forces = _forces(ours, q)
    size = float(np.abs(forces).max()) or 1.0
    errors = {one.name: float(np.abs(one.limit() - forces).max()) / size for one in strained}
    error = max(errors.values())
    verdict: Status = "agree" if error <= EQUAL else "disagree"
    return Comparison(label, engine, EXACT, verdict, len(q), error, EQUAL, note=", ".join(errors))


def judge_damping(label: str, engine: str, beam: BeamElements, ours: sf.Model, v: Array) -> Comparison:
    """Whether the forces of damping at the straight beam are its stiffness times the retardation time.

    Args:
        label: Label of the model.
        engine: Name of the engine.
        beam: The beam's elements.
        ours: The same beam of ours, clamped.
        v: Elastic speeds (N, n).
    """
    forces = _forces(ours, 0.0 * v, v)
    error = float(np.abs(beam.damping(v).limit() - forces).max()) / (float(np.abs(forces).max()) or 1.0)
    note = f"beam '{beam.described.name}'"
    verdict: Status = "agree" if error <= EQUAL else "disagree"
    return Comparison(label, engine, DAMPING, verdict, len(v), error, EQUAL, note=note)


def judge_rotary(
    label: str, engine: TreeEngine, ours: SymofrosEngine, assembly: Assembly, states: States
) -> Comparison:
    """Whether M and h with rotary inertia differ by the order of its spins; nothing else is compared with it.

    Args:
        label: Label of the model.
        engine: The engine, with rotary inertia.
        ours: Our model with it, every term kept.
        assembly: The model as numbers; its elastic coordinates and speeds are scaled.
        states: The states.
    """
    sizes = {"M": float(np.abs(ours.mass_matrix(states)).max()), "h": float(np.abs(ours.bias(states)).max())}
    at = {}
    for eps in ROTARY_SCALES:
        few = scaled(assembly, states, eps)
        pairs = {
            "M": (ours.mass_matrix(few), engine.mass_matrix(few)),
            "h": (ours.bias(few), engine.bias(few)),
        }
        at[eps] = {name: float(np.abs(a - b).max()) / sizes[name] for name, (a, b) in pairs.items()}
    row = Comparison(label, engine.name, ROTARY, "agree", len(states))
    return _by_powers(row, ROTARY_POWER, at, ROTARY_RESOLVED)


def _forces(model: sf.Model, q: Array, v: Array | None = None) -> Array:
    return model.generalized_force(q, 0.0 * q if v is None else v, np.zeros((len(q), 0)))


def _by_powers(row: Comparison, stated: int, at: dict[float, dict[str, float]], resolved: float) -> Comparison:
    """A row with its verdict.

    Args:
        row: Model, engine, quantity and states.
        stated: The power that differences must have.
        at: Differences of each quantity at the coarse scale and at the fine one.
        resolved: Differences below this have no power.
    """
    (coarse_scale, coarse), (fine_scale, fine) = at.items()
    if not all(math.isfinite(value) for value in (*coarse.values(), *fine.values())):
        return replace(row, status="disagree", note="not a finite number in some state")
    allowed = {
        name: max(value * (fine_scale / coarse_scale) ** (stated - MARGIN), resolved) for name, value in coarse.items()
    }
    worst = max(fine, key=lambda name: fine[name] / allowed[name])
    powers = {
        name: math.log(coarse[name] / value) / math.log(coarse_scale / fine_scale)
        for name, value in fine.items()
        if value > resolved
    }
    shown = [
        f"{name} by power {powers[name]:.2f}" if name in powers else f"{name} by nothing resolved" for name in fine
    ]
    return replace(
        row,
        status="agree" if fine[worst] <= allowed[worst] else "disagree",
        error=fine[worst],
        tolerance=allowed[worst],
        note=f"differences by powers of the deflection: {', '.join(shown)}",
        extra={"power": min(powers.values())} if powers else {},
    )
