"""Which procedures are asked of which models: each of a few small ones that have what the procedure turns on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

import symofros as sf

from .. import references
from ..comparison.errors import Comparison, Status
from ..contract.raised import not_installed
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array
from . import ENGINE, blocks, diagrams, machines
from .equations import analyses, beams, contacts, forces, identities, reactions
from .formats import differences, exchanged, exported, files
from .motions import batches, by_hand, notes, runs, switching, zeros
from .scene import Cell, Manifold, Scene

Procedure = Callable[[Scene], Iterator[Cell]]
SEED = 3
SMALL = 0.03


@dataclass(frozen=True)
class _Driven:
    """Inputs of a pendulum of two joints: one by a formula of the state, one that is smooth, or sampled, in time."""

    sampled: bool

    def __call__(self, t: float, q: Array, v: Array) -> Array:
        second = np.interp(t, [0.0, 0.3, 0.5], [1.0, -1.0, 2.0]) if self.sampled else 0.4 * np.sin(5 * t)
        return np.array([0.3 * np.cos(3 * t) - 0.2 * q[1] * v[0], second])

    @property
    def stated(self) -> dict[str, object]:
        """The same, as runs are given them."""
        samples = sf.Signal([0.0, 0.3, 0.5], [1.0, -1.0, 2.0])
        return {"q1": "0.3*cos(3*t) - 0.2*q2*dq1", "q2": samples if self.sampled else "0.4*sin(5*t)"}


def _inputs(sampled: bool, procedure: Procedure) -> Procedure:
    law = _Driven(sampled)
    return lambda scene: procedure(replace(scene, law=law, u=law.stated))


def _events(scene: Scene) -> Iterator[Cell]:
    formulas = {
        "both 0.1": sf.Event("q1 - 0.1"),
        "falling 0.3": sf.Event("q2 - 0.3", "falling"),
        "rising -0.2": sf.Event("q1 + 0.2", "rising"),
        "end 1.9": sf.Event("q2 - 1.9", "both", True),
    }
    return runs.events(scene, formulas, {"both 0.1": 0, "falling 0.3": 1, "rising -0.2": 0, "end 1.9": 1})


def _oscillations(_: Scene) -> Iterator[Cell]:
    model = batches.oscillator()
    yield from batches.amplified(model)
    yield from batches.remarks(model)


_MOVED: tuple[Procedure, ...] = (runs.fixed_steps, runs.chosen_steps, analyses.linearised, analyses.differentiated)
_TAKEN_OTHERWISE: tuple[Procedure, ...] = (
    machines.taped,
    machines.laid_out,
    machines.parameterised,
    machines.resumed,
    machines.rolled_out,
)
# What needs no reference model: small ones of their own.
_OF_THEIR_OWN: tuple[Procedure, ...] = (
    forces.formulas,
    forces.applied,
    forces.each_coordinate,
    forces.rods,
    beams.in_a_plane,
    contacts.contacts,
    files.read,
    differences.first_differences,
    switching.engaged,
    switching.grasped,
    switching.struck,
    switching.stuck,
    runs.turned,
    zeros.of_time,
    zeros.of_motions,
    notes.on_steps,
    notes.on_inputs,
    notes.on_motions,
    blocks.timed,
    exchanged.by_mujoco,
    exchanged.by_pinocchio,
    exchanged.noted,
    exported.planned,
)
_DIFFERENTIATED: tuple[Procedure, ...] = (
    identities.balanced,
    identities.moving_frames,
    identities.transposed,
    identities.twice_differentiated,
    identities.momenta,
)
PROCEDURES: Mapping[str, tuple[Procedure, ...]] = {
    "double_pendulum": (
        _inputs(True, runs.fixed_steps),
        _inputs(False, runs.chosen_steps),
        _inputs(False, runs.implicit_steps),
        _inputs(True, runs.records),
        _events,
        lambda scene: runs.multistep(scene, ("cvode", "cvode_adams")),
        runs.pace,
        by_hand.stepped,
        by_hand.held,
        by_hand.instants,
        by_hand.reversed_motion,
        by_hand.acted,
        by_hand.sampled_finely,
        lambda scene: blocks.computed(scene.system),
        lambda scene: blocks.fed(scene.system),
        by_hand.run_notes,
        exported.in_casadi,
        batches.trajectories,
        batches.lost,
        batches.states,
        analyses.linearised,
        analyses.differentiated,
        analyses.identified,
        *_DIFFERENTIATED,
        *_TAKEN_OTHERWISE,
        lambda scene: analyses.at_rest(scene, scene.q),
        lambda scene: analyses.at_rest(scene, scene.q, ("q2",)),
        lambda scene: analyses.driven(scene, ("q1", "q2")),
    ),
    "heavy_top": (
        *_MOVED,
        *_DIFFERENTIATED,
        *_TAKEN_OTHERWISE,
        runs.small_turns,
        runs.implicit_steps,
        by_hand.reversed_motion,
        by_hand.stepped,
        by_hand.along,
        exported.in_casadi,
        batches.trajectories,
    ),
    "torque_free_body": (
        *_MOVED,
        *_TAKEN_OTHERWISE,
        identities.twice_differentiated,
        identities.momenta,
        runs.implicit_steps,
    ),
    "four_bar": (
        *_MOVED,
        identities.transposed,
        runs.implicit_steps,
        runs.stabilised,
        lambda scene: runs.scaled_steps(scene, ((), ())),
        lambda scene: runs.multistep(scene, ("ida", "cvode")),
        batches.trajectories,
        lambda scene: analyses.closed(scene, "q1"),
        lambda scene: analyses.at_rest(scene, scene.q),
        lambda scene: analyses.driven(scene, ("q1", "q2")),
        reactions.of_constraints,
        identities.weighted_curvature,
        by_hand.stepped,
        by_hand.balanced,
        blocks.begun,
        machines.taped,
        machines.resumed,
        exported.packages,
    ),
    "space_arm": (analyses.identified, identities.momenta, by_hand.drifting, by_hand.along),
    "friction_arm": (lambda scene: analyses.driven(scene, scene.model.names.u),),
    "sleigh": (runs.implicit_steps,),
    "rolling_disc": (
        runs.fixed_steps,
        runs.chosen_steps,
        lambda scene: runs.scaled_steps(scene, ((0, 1, 2), (0, 1, 2))),
        reactions.of_constraints,
        lambda scene: analyses.closed(scene, scene.model.names.v[3]),
    ),
    "puma560": (
        lambda scene: analyses.reached(scene, scene.model.names.frames[-1]),
        lambda scene: analyses.traced(scene, scene.model.names.frames[-1]),
    ),
    "stanford_arm": (lambda scene: analyses.reached(scene, scene.model.names.frames[-1]),),
    "pendulum": (
        *_OF_THEIR_OWN,
        reactions.of_drives,
        _oscillations,
        lambda _: diagrams.switched(),
        lambda _: diagrams.sampled(),
    ),
    "cart_pole": (
        lambda scene: diagrams.looped(scene.system),
        lambda scene: diagrams.stored(scene.system),
        identities.weighted_curvature,
    ),
    "stewart": (lambda scene: analyses.driven(scene, scene.model.names.u), reactions.of_constraints),
    "soft_pendulum": (runs.stated_error, beams.sampled_shapes, beams.power),
    "flexible_pendulum": (
        runs.implicit_steps,
        lambda scene: analyses.at_rest(scene, scene.model.neutral() + 0.1),
        runs.mirrored,
        reactions.of_sections,
        identities.transposed,
    ),
}


def judge_procedures(label: str, system: sf.System, assembly: Assembly) -> Iterator[Comparison]:
    """Comparisons of procedures on a reference model's equations with independent formulas; none for most models.

    Args:
        label: Name of the model in tables.
        system: Description; those of reference models count, not of files that are called the same.
        assembly: The same as numbers.
    """
    procedures = PROCEDURES.get(label, ())
    if not procedures or system is not references.MODELS[label]:
        return
    scene = first_scene(system, assembly)
    for procedure in procedures:
        try:
            yield from (row(label, cell) for cell in procedure(scene))
        except Exception as error:  # What a defect of ours raises is a row, too.
            missing = not_installed(error)
            status: Status = "unsupported" if missing else "failed"
            note = missing or f"{type(error).__name__}: {error}"
            yield Comparison(label, ENGINE, "procedure", status, note=note)


def row(label: str, cell: Cell) -> Comparison:
    """A cell as a row of the check's table."""
    if cell.absent:
        return Comparison(label, ENGINE, cell.name, "unsupported", note=cell.absent)
    agrees = cell.error <= cell.tolerance
    return Comparison(
        label, ENGINE, cell.name, "agree" if agrees else "disagree", 1, cell.error, cell.tolerance, note=cell.note
    )


def first_scene(system: sf.System, assembly: Assembly, backend: Literal["c", "interpreter"] = "c") -> Scene:
    """A model at a random state, assembled, with constant inputs."""
    model = sf.compile(system, sf.Options(backend=backend))
    q, v = model.random_state(np.random.default_rng(SEED))
    if model.nc:
        start = sf.assemble(model, q, v)
        q, v = start.q, start.v
    if bool(system.beams):  # Small, as its theory asks for.
        neutral = model.neutral()
        q, v = model.integrate(neutral, SMALL * model.difference(neutral, q)), SMALL * v
    u = np.linspace(0.3, 0.5, model.nu)
    return Scene(model, system, Manifold.of(assembly), q, v, lambda *_: u, u, backend=backend)
