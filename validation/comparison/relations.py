"""What our program of one description owes to that of another which states the same mechanism: no reference is asked.

A restated description makes another program: other frames, another order of the tree, other bodies, other scales. Both
are evaluated at the same states, one by C and one by the interpreter, and differ by rounding alone. The bounds are
those of engines (`contract/quantities.py`): sums of some hundred products, with a margin; solutions by cond(M).
Turned by R, a component is a sum of three, and a place is shifted by at most 9 m; in other units every number is
rounded once more. Each is of the size that the margin of 1e-12 over 1e-14 is for.
"""

from __future__ import annotations

import tempfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

import symofros as sf

from ..adapters.compiled import SymofrosEngine
from ..contract.interface import States, Subject, Unsupported
from ..contract.quantities import QUANTITIES, Quantity
from ..contract.raised import Raised, attempted, not_installed
from ..mechanics.assembly import BASE, Assembly
from ..mechanics.geometry import Array, Placement
from .errors import Comparison, Scales, compute, raised, scaled_errors
from .participants import EPS
from .restated import RESTATEMENTS, Restated

# Name of the other side of the rows.
ENGINE = "relations"
# The special states and some random ones: a wrong term shows in nearly every state.
STATES = 12
COMPARED = (
    "mass_matrix",
    "bias",
    "generalized_force",
    "kinetic_energy",
    "potential_energy",
    "frame_pose",
    "frame_velocity",
)
# Of files of other formats, which hold no formulas and few forces.
INERTIAL = ("mass_matrix", "bias", "kinetic_energy")
# Entries whose bits differ: none may.
BITS = 0.5
# Speeds of the largest model that is restated in every way; of larger ones the world alone is moved.
LARGE, SHIFTED = 30, "the world turned and shifted"
# Vectors of doubles have 2, 4 or 8 lanes: behind the last whole one, 1 to 7 states are left.
LANES = 8
# From so many states on a batch runs by vectors.
BATCH = 256


@dataclass(frozen=True)
class RestatedEngine:
    """A restated model, asked in the original's coordinates, its answers in the original's units and world.

    Attributes:
        restated: How it is stated.
        model: Its program, by the interpreter.
        original: Our model of the original.
        assembly: The original as numbers.
        frames: Frames of the original.
    """

    restated: Restated
    model: sf.Model
    original: sf.Model
    assembly: Assembly
    frames: tuple[str, ...]

    def _order(self, names: tuple[str, ...], others: tuple[str, ...]) -> list[int]:
        """Place here of each name of the original; other names stand in the same order."""
        if self.restated.same_order:
            return list(range(len(names)))
        return [others.index(name) for name in names]

    @cached_property
    def _speeds(self) -> list[int]:
        return self._order(self.original.names.v, self.model.names.v)

    @cached_property
    def _per_speed(self) -> Array:
        """Factors of the speeds (nv), in the original's order."""
        units, factors = self.restated.units, np.ones(self.original.nv)
        for mover in self.assembly.movers:
            size = mover.v.stop - mover.v.start
            lengths = 3 if mover.kind == "free" else size if mover.kind == "prismatic" else 0
            factors[mover.v] = [units.length] * lengths + [1.0] * (size - lengths)
        return factors / units.time

    def _stated(self, states: States) -> States:
        """The states in the coordinates, speeds and inputs of the restated model."""
        units, lengths = self.restated.units, np.ones(self.original.nq)
        for mover in self.assembly.movers:
            size = {"free": 3, "prismatic": mover.q.stop - mover.q.start}.get(mover.kind, 0)
            lengths[mover.q.start : mover.q.start + size] = units.length
        names, others = self.original.names, self.model.names
        q, v, a, u = (np.zeros((len(states), n)) for n in (self.model.nq, self.model.nv, self.model.nv, self.model.nu))
        q[:, self._order(names.q, others.q)] = states.q * lengths
        v[:, self._speeds] = states.v * self._per_speed
        a[:, self._speeds] = states.a * self._per_speed / units.time
        if self.restated.forces:
            u[:, self._order(names.u, others.u)] = states.u * self._per_input
        return States(q, v, a, u, np.zeros_like(v), np.zeros_like(v))

    @cached_property
    def _per_input(self) -> Array:
        """Factors of the inputs: those of actuated joints are efforts on their speeds, others are in formulas."""
        forces = self._power / self._per_speed
        speeds = {name: forces[k] for k, name in enumerate(self.original.names.v)}
        return np.array([speeds.get(name, 1.0) for name in self.original.names.u])

    @property
    def _energy(self) -> float:
        return self.restated.units.factor("N m")

    @property
    def _power(self) -> float:
        return self.restated.units.factor("N m/s")

    def value(self, quantity: Quantity, states: States) -> Array:
        """The answer for a quantity in the original's order, units and world."""
        at = self._stated(states)
        asked = at.at_rest() if quantity.at_rest else at
        frames = tuple(self.restated.names.get(name, name) for name in self.frames)
        value = compute(SymofrosEngine(ENGINE, self.model, frames), quantity, asked)
        return np.asarray(getattr(self, f"_own_{quantity.name}", self._own_force)(value, states))

    def _own_mass_matrix(self, M: Array, _: States) -> Array:
        n, f = self._speeds, self._per_speed
        return np.asarray(M[:, n][:, :, n] * f[:, None] * f / self._energy)

    def _own_force(self, force: Array, _: States) -> Array:
        return np.asarray(force[:, self._speeds] * self._per_speed / self._power)

    def _own_forward_dynamics(self, a: Array, _: States) -> Array:
        return np.asarray(a[:, self._speeds] * self.restated.units.time / self._per_speed)

    def _own_kinetic_energy(self, T: Array, _: States) -> Array:
        return T / self._energy

    def _own_potential_energy(self, V: Array, _: States) -> Array:
        return V / self._energy

    def _own_frame_pose(self, poses: Array, _: States) -> Array:
        world = self.restated.world
        p = (poses[..., :3] / self.restated.units.length - world.p) @ world.R
        R = world.R.T @ poses[..., 3:].reshape(*poses.shape[:-1], 3, 3)
        return np.concatenate([p, R.reshape(*poses.shape[:-1], 9)], axis=-1)

    def _own_frame_velocity(self, velocities: Array, _: States) -> Array:
        R, units = self.restated.world.R, self.restated.units
        linear, angular = velocities[..., :3] / units.length, velocities[..., 3:]
        return np.concatenate([linear @ R, angular @ R], axis=-1) * units.time


@dataclass(frozen=True)
class Related:
    """What relations are judged by.

    Attributes:
        subject: The subject, its frames chosen.
        assembly: The same as numbers.
        ours: Our model of it.
        states: States with forces.
        scales: Typical sizes of M and T.
        condition: Factor by which solving for v' amplifies rounding.
        batch: All states of the check, whether they keep constraints or not.
        vectors: Our model by vectors, if it is asked.
        full: Whether large models are asked for every relation.
    """

    subject: Subject
    assembly: Assembly
    ours: SymofrosEngine
    states: States
    scales: Scales
    condition: float
    batch: States
    vectors: SymofrosEngine | None = None
    full: bool = False


def judge_relations(asked: Related) -> Iterator[Comparison]:
    """A row a relation; one that can't be asked of the model says why."""
    label, system = asked.subject.label, asked.subject.system
    for name, restate in RESTATEMENTS.items():
        if not asked.full and asked.ours.model.nv > LARGE and name != SHIFTED:
            note = f"{asked.ours.model.nv} speeds; beyond {LARGE} `check --full` asks"
            yield Comparison(label, ENGINE, name, "unsupported", note=note)
            continue
        rng = np.random.default_rng(zlib.crc32(f"{label} {name}".encode()))
        yield _attempted(asked, name, lambda restate=restate, rng=rng: restate(system, rng))  # type: ignore[misc]
    yield _attempted(asked, "written and read again", lambda: _read_again(system))
    for target in ("urdf", "mjcf"):
        name = f"exported as {target.upper()} and read again"
        yield _attempted(asked, name, lambda target=target: _exported(asked, target))  # type: ignore[misc]
    for name, count in (("asked again, in another order", _asked_again), ("tails of vectors", _tails)):
        differing = attempted(count, asked)
        if isinstance(differing, Raised):
            yield raised(label, ENGINE, name, differing)
        elif isinstance(differing, Unsupported):
            yield Comparison(label, ENGINE, name, "unsupported", note=differing.reason)
        else:
            yield _row(asked, name, float(differing), BITS, "entries of other bits")


def _attempted(asked: Related, name: str, restate: Callable[[], Restated | Unsupported]) -> Comparison:
    """The row of one restatement."""
    label = asked.subject.label
    other = attempted(restate)
    if isinstance(other, Unsupported):
        return Comparison(label, ENGINE, name, "unsupported", note=other.reason)
    row = other if isinstance(other, Raised) else attempted(_compared, asked, name, other)
    return raised(label, ENGINE, name, row) if isinstance(row, Raised) else row


def _compared(asked: Related, name: str, other: Restated) -> Comparison:
    """The worst of all quantities, by its share of the tolerance."""
    if other.system == asked.subject.system:  # Equal descriptions are one program.
        return _row(asked, name, 0.0, QUANTITIES["mass_matrix"].tolerance)
    frames = asked.subject.frames if other.forces else ()
    compared = COMPARED if other.forces else INERTIAL
    quantities = [QUANTITIES[one] for one in compared if frames or not one.startswith("frame")]
    if other.forces and asked.subject.system.constraints and np.isfinite(asked.condition):
        quantities.append(QUANTITIES["forward_dynamics"])
    named = tuple(other.names.get(one, one) for one in frames)
    options = sf.Options(tuple(q.method or q.name for q in quantities), named, backend="interpreter")
    engine = RestatedEngine(other, sf.compile(other.system, options), asked.ours.model, asked.assembly, frames)
    states, shares = asked.states[:STATES], []
    for quantity in quantities:
        tolerance = other.margin * quantity.tolerance
        if quantity.name == "forward_dynamics":
            tolerance = max(tolerance, EPS * asked.condition)
        ours, theirs = compute(asked.ours, quantity, states), engine.value(quantity, states)
        if quantity.name == "potential_energy":  # Its zero is that of the world's origin, wherever that is.
            size = max(float(np.abs(x).max()) for x in (ours, theirs)) or 1.0
            errors = np.abs((ours - ours[0]) - (theirs - theirs[0])) / size
        else:
            errors, _ = scaled_errors(quantity, ours, theirs, asked.scales)
        error = float(errors.max()) if np.all(np.isfinite(errors)) else np.inf
        shares.append((error / tolerance, error, tolerance, quantity.name))
    share, error, tolerance, worst = max(shares)
    return _row(asked, name, error, tolerance, "" if share == 0.0 else f"largest in {worst}")


def _row(asked: Related, name: str, error: float, tolerance: float, note: str = "") -> Comparison:
    agrees = error <= tolerance
    count = min(STATES, len(asked.states))
    finite = error if np.isfinite(error) else None
    return Comparison(
        asked.subject.label, ENGINE, name, "agree" if agrees else "disagree", count, finite, tolerance, note=note
    )


def _exported(asked: Related, target: Literal["urdf", "mjcf"]) -> Restated | Unsupported:
    """What is read from a file of another format that the description was exported as."""
    system, names = asked.subject.system, asked.ours.model.names
    joints = [one.joint for one in asked.assembly.joints]
    if any(joint.rotors or (target == "urdf" and joint.armature != 0.0) for joint in joints):
        return Unsupported("the format holds no rotors, or no armatures")
    bases = [mover for mover in asked.assembly.movers if mover.kind == "free"]
    if target == "mjcf" and any(mover.parent != BASE or _is_moved(mover.X_AP) for mover in bases):
        return Unsupported("free joints of MJCF have their poses in the world")
    with tempfile.TemporaryDirectory() as folder:
        try:
            file = next(path for path in sf.export(system, target, folder).files if path.suffix in (".urdf", ".xml"))
        except sf.SymofrosError as refusal:
            return Unsupported(f"not exported: {refusal.problem.what}")
        try:
            floats = target == "urdf" and bool(bases)
            again = sf.load(file, snap_tol=0.0, floating_base=floats)
        except sf.SymofrosError as refusal:
            if missing := not_installed(refusal):
                return Unsupported(missing)
            if "inertia must satisfy" not in str(refusal):
                raise
            return Unsupported("MuJoCo refuses inertias beyond A + B = C, rounded or not")
    read = sf.compile(again, sf.Options(("mass_matrix",), (), backend="interpreter")).names
    if {*read.q} != {*names.q}:
        return Unsupported("the format has other coordinates, or other names of them")
    x, y, z = map(float, asked.assembly.gravity)  # URDF has no word for it.
    # Quaternions of MJCF round every entry of a turn, exact zeros too, which adds up along the links of a humanoid:
    # 4e-13 of T for 38 speeds.
    return Restated(replace(again, gravity=(x, y, z)), forces=False, margin=10.0 if target == "mjcf" else 1.0)


def _is_moved(place: Placement) -> bool:
    return not (np.array_equal(place.R, np.eye(3)) and not np.any(place.p))


def _read_again(system: sf.System) -> Restated:
    """The description, written as a file of ours, of what was read from it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "again.yaml")
        sf.save(system, path)
        return Restated(sf.load(path))


def _asked_again(asked: Related) -> int:
    """Entries that change when the same functions are asked again, the last ones first, other states in between."""
    quantities = [QUANTITIES[one] for one in COMPARED if asked.subject.frames or not one.startswith("frame")]
    states = asked.states[:STATES]
    first = [compute(asked.ours, quantity, states) for quantity in quantities]
    differing = 0
    for quantity, value in reversed(list(zip(quantities, first, strict=True))):
        compute(asked.ours, quantity, asked.states[-STATES:].at_rest())
        alone = [compute(asked.ours, quantity, states[i : i + 1])[0] for i in reversed(range(len(states)))]
        differing += _differing(np.array(alone)[::-1], value)
    return differing


def _tails(asked: Related) -> int | Unsupported:
    """Entries of the last states of batches that differ from those of the same states within a longer batch."""
    if asked.vectors is None:
        return Unsupported("'vectors' is not among the engines")
    most = BATCH + LANES - 1
    if len(asked.batch) < most + LANES:
        return Unsupported(f"fewer than {most + LANES} states, with which batches run by vectors")
    differing = 0
    for name in asked.vectors.capabilities:
        whole = compute(asked.vectors, QUANTITIES[name], asked.batch)
        for size in range(BATCH, most + 1):
            tail = compute(asked.vectors, QUANTITIES[name], asked.batch[:size])
            differing += _differing(tail[size - LANES :], whole[size - LANES : size])
    return differing


def _differing(one: Array, other: Array) -> int:
    """Number of entries that differ; 0 and -0 are equal, and so are two that are no numbers."""
    return int(np.sum(~((one == other) | (np.isnan(one) & np.isnan(other)))))
