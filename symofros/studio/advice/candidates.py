"""Reductions: what may be left out of a system, what each is expected to cost, and how it is done."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from symofros.base.names import name_of
from symofros.description import DIRECTIONS, STATIONS, Beam, Direction, Joint, Spring, System, as_value
from symofros.studio.advice import estimators
from symofros.studio.advice.loads import BeamLoads, Observed

Kind = Literal[
    "rigid",
    "direction",
    "theory",
    "functions",
    "foreshortening",
    "order",
    "rotary inertia",
    "rotor",
    "elastic joint",
    "constants",
]
# Deflections below this share of the length are rounding.
_NOTHING = 1e-12
_PLANES: tuple[Direction, ...] = ("bend_y", "bend_z")


@dataclass(frozen=True)
class Reduction:
    """One thing left out.

    Attributes:
        subject: Part of the model, such as "beam 'link1'".
        change: Change made to it, such as "rigid".
        kind: Kind of the reduction.
        estimate: Expected error of the scene's outputs, in units of what is allowed.
        reason: Basis of the estimate, with numbers.
        numbers: The same for programs.
        apply: System -> System; the same one where there is nothing left to do.
    """

    subject: str
    change: str
    kind: Kind
    estimate: float
    reason: str
    apply: Callable[[System], System]
    numbers: Mapping[str, float] = field(default_factory=dict)


def candidates(seen: Observed) -> Iterator[Reduction]:
    """All but the numbers of functions, which depend on what the others leave."""
    for body in seen.system.bodies:
        if isinstance(body, Beam) and body.modes:
            yield from _beam_candidates(seen.beam(body))
        if body.joint is not None:
            yield from _of_joint(seen, body.name, body.joint)


def fewer_functions(loads: BeamLoads, current: Beam) -> Iterator[Reduction]:
    """Smaller sets of shape functions, the smallest first: of cantilever modes, then of the beam's own family."""
    if current.family in ("user", "hermite"):
        return  # A user's functions are chosen by the user; two of hermite's are the least.
    most = max(getattr(current, direction) for direction in DIRECTIONS)
    for count in range(1, most + 1):
        for family in dict.fromkeys((current.elastic.mode_family or current.family, current.family)):
            counts = {direction: min(count, getattr(current, direction)) for direction in DIRECTIONS}
            if sum(counts.values()) >= current.modes:
                continue
            modal = family == "clamped_free"
            left = [loads.deflection(direction, n, modal) for direction, n in counts.items() if n]
            missed, slope = (sum(column) for column in zip(*left, strict=True))
            shown = ", ".join(f"{direction} {n}" for direction, n in counts.items() if n)
            whole = sum(loads.deflection(direction).displacement for direction in _bending(current))
            yield Reduction(
                f"beam '{current.name}'",
                f"{shown} of {family}",
                "functions",
                sum(map(loads.share, left)),
                f"of a static {_length(whole)} at the tip they miss {_length(missed)} and a slope of {slope:.2g} rad",
                changed_beam(current.name, family=family, **counts),
                {"displacement": missed, "slope": slope},
            )


def constants(system: System, keep: tuple[str, ...]) -> Reduction:
    """Parameters that neither scene nor events vary, hard-coded: exact, and what zeros multiply vanishes."""
    varied = {*keep, *(name_of(to) for event in system.events.values() for to in event.action or ())}
    free = [parameter for parameter in system.parameters if not parameter.constant and parameter.name not in varied]
    zeros = [parameter.name for parameter in free if parameter.value == 0.0]
    names = {parameter.name for parameter in free}

    def apply(current: System) -> System:
        changed = (replace(p, constant=True) if p.name in names else p for p in current.parameters)
        return replace(current, parameters=tuple(changed))

    vanish = f"; terms with {', '.join(zeros)} = 0 vanish" if zeros else ""
    return Reduction(
        "parameters",
        f"{len(free)} made constants",
        "constants",
        0.0,
        f"the scene keeps {', '.join(keep) or 'none of them'} at run time{vanish}",
        apply,
    )


def _bending(beam: Beam) -> list[Direction]:
    return [direction for direction in _PLANES if getattr(beam, direction)]


def _beam_candidates(loads: BeamLoads) -> Iterator[Reduction]:
    beam, what = loads.beam, f"beam '{loads.beam.name}'"
    flexible = [direction for direction in DIRECTIONS if getattr(beam, direction)]
    by = {direction: _bent(loads, direction) for direction in flexible}
    total = sum(moved for moved, _, _ in by.values())
    none = dict.fromkeys(DIRECTIONS, 0)
    reason = "; ".join(text for _, text, _ in by.values())
    numbers = {f"{key}.{name}": value for key, (_, _, more) in by.items() for name, value in more.items()}
    yield Reduction(
        what,
        "rigid",
        "rigid",
        total,
        f"{reason}; simulated, its tip moves {_length(loads.tip)} across",
        changed_beam(beam.name, **none, stations=STATIONS),
        numbers,
    )
    if len(flexible) > 1 and not beam.is_coupled:  # A direction by itself tells nothing of what others bring to it.
        for direction, (moved, text, more) in by.items():
            yield Reduction(
                what, f"rigid in {direction}", "direction", moved, text, changed_beam(beam.name, **{direction: 0}), more
            )
    bending = _bending(beam)
    yield from lower_orders(loads)
    given = {d: loads.beam.rhoI_z if d == "bend_y" else loads.beam.rhoI_y for d in bending}
    if beam.rotary_inertia and any(value != 0.0 for value in given.values()):
        yield _rotary_inertia_candidate(loads, what, bending)


def _bent(loads: BeamLoads, direction: Direction) -> tuple[float, str, dict[str, float]]:
    """Change of outputs by deflection and vibration in a direction, in units of the tolerance; in words; in numbers."""
    static = loads.deflection(direction)
    if direction == "twist":
        return loads.share(static), f"twist: static {static.slope:.2g} rad", {"static": static.slope}
    periods = loads.periods(direction)
    left = estimators.residual_bound(periods)
    text = f"{direction}: static {_length(static.displacement)} at the tip"
    if static.displacement > _NOTHING * loads.length:
        text += f", of which a load of {periods:.3g} periods leaves {100 * left:.2g} % vibrating"
    numbers = {"static": static.displacement, "periods": periods, "residual": left}
    return loads.share(static) * (1.0 + left), text, numbers


def lower_orders(loads: BeamLoads) -> Iterator[Reduction]:
    """Terms of second order and foreshortening left out, of a beam that has them."""
    beam, what, bending = loads.beam, f"beam '{loads.beam.name}'", _bending(loads.beam)
    if not bending or beam.retain == "zeroth_order" or beam.elastic.is_exact:
        return
    if beam.retain == "all":
        slope = max(loads.deflection(direction).displacement for direction in bending) / loads.length
        error = slope**2 * loads.tip
        yield Reduction(
            what,
            "first order",
            "order",
            error * loads.gain,
            f"terms of second order are about {slope**2:.2g} of the deflection, {_length(error)}",
            changed_beam(beam.name, retain="first_order"),
            {"slope": slope},
        )
    ratio = max(estimators.critical_ratio(loads.eta(direction)) for direction in bending)
    shift = max(loads.stiffening(direction) for direction in bending)
    # A stiffness that is off by twice the shift of the frequency is off by as much in the deflection.
    error = 2.0 * shift * loads.tip
    yield Reduction(
        what,
        "no foreshortening",
        "foreshortening",
        error * loads.gain,
        f"spin is {ratio:.3g} of the critical speed; it stiffens the first mode by {100 * shift:.3g} %,"
        f" {_length(error)} of a deflection of {_length(loads.tip)}",
        changed_beam(beam.name, retain="zeroth_order", foreshortening=False),
        {"critical_ratio": ratio, "shift": shift},
    )


def _rotary_inertia_candidate(loads: BeamLoads, what: str, bending: list[Direction]) -> Reduction:
    labels = {"bend_y": "rhoI_z", "bend_z": "rhoI_y"}
    beam = loads.beam
    values = [getattr(beam, labels[direction]) for direction in bending]
    # Where a section tapers, the middle stands for all: it is an estimate.
    sizes = [value if isinstance(value, float) else math.nan for value in values]
    shift = max(
        (estimators.rotary_shift(size, loads.rhoA, loads.length) for size in sizes if not math.isnan(size)), default=0.0
    )
    error = 2.0 * shift * loads.tip
    return Reduction(
        what,
        "no rotary inertia",
        "rotary inertia",
        error * loads.gain,
        f"it lowers the first frequency by {100 * shift:.2g} %, {_length(error)} of a deflection of"
        f" {_length(loads.tip)}",
        changed_beam(beam.name, rotary_inertia=False),
        {"shift": shift},
    )


def _of_joint(seen: Observed, body: str, joint: Joint) -> Iterator[Reduction]:
    own = [rotor for rotor in joint.rotors if rotor.carrier is None and rotor.axis is None]
    single = joint.traits.series and joint.traits.nv == 1
    names = seen.reference.run.model.names
    if not single or joint.prescribed or joint.name not in names.q:
        return
    root = seen.poses[body][0]
    moved = seen.reference.run.q[:, names.q.index(joint.name)]
    if own and len(own) == len(joint.rotors) and joint.traits.turns_about == "axis":
        least = min(abs(seen.number(rotor.ratio)) for rotor in own)
        travel = float(np.ptp(moved))
        estimate = travel / least * seen.reach(body, root, 1.0)[1] if least > 0.0 else math.inf
        yield Reduction(
            f"joint '{joint.name}'",
            "rotor as armature",
            "rotor",
            estimate,
            f"what is lost is one in {least:.3g} of the rotor's moments; the joint travels {travel:.3g}",
            _armature(body),
            {"ratio": least},
        )
    springs = [element for element in joint.elements if isinstance(element, Spring)]
    free = not joint.actuated and not joint.effort and not joint.rotors
    start = float(seen.scene.start.get(joint.name, 0.0))
    if springs and free and start == 0.0:
        largest = float(np.abs(moved).max())
        yield Reduction(
            f"joint '{joint.name}'",
            "locked",
            "elastic joint",
            largest * seen.reach(body, root, 1.0)[1],
            f"its spring gives way by {largest:.2g} at most",
            _locked(body),
            {"travel": largest},
        )


def changed_beam(name: str, **changed: Any) -> Callable[[System], System]:
    """A function that replaces attributes of a beam of a system."""

    def apply(system: System) -> System:
        body = system.body(name)
        assert isinstance(body, Beam)
        return system.with_bodies(replace(body, **changed))

    return apply


def _armature(name: str) -> Callable[[System], System]:
    def apply(system: System) -> System:
        body = system.body(name)
        assert body.joint is not None
        terms = [f"({rotor.inertia})*({rotor.ratio})^2" for rotor in body.joint.rotors]
        total = " + ".join([*([str(body.joint.armature)] if body.joint.armature != 0.0 else []), *terms])
        joint = replace(body.joint, armature=as_value(total), rotors=())
        return system.with_bodies(replace(body, joint=joint))

    return apply


def _locked(name: str) -> Callable[[System], System]:
    def apply(system: System) -> System:
        body = system.body(name)
        assert body.joint is not None
        joint = Joint(
            body.joint.name, "fixed", body.joint.parent, body.joint.frame, body.joint.position, body.joint.rotation
        )
        return system.with_bodies(replace(body, joint=joint))

    return apply


def _length(metres: float) -> str:
    if metres == 0.0:
        return "0 mm"
    return f"{1e3 * metres:.3g} mm" if 1e-6 <= metres < 1.0 else f"{metres:.3g} m"
