"""The Lagrangian engine: against engines for rigid trees where there are no beams to speak of, and on its own beams."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.cases import CASES
from tests.mechanics.beams.rods import CASES as RODS
from tests.mechanics.beams.rods import rod_system
from tests.models import sampled
from tests.validation.subjects import UNIT, every_kind, floating_arm, states_of, subject_of
from validation.adapters import compiled
from validation.adapters.compiled import SymofrosEngine, untruncated
from validation.adapters.lagrangian import engine as lagrangian
from validation.adapters.pinocchio import tree as pinocchio
from validation.checking import ModelResult, Settings, check
from validation.comparison.errors import state_errors, typical_scales
from validation.comparison.retained import judge_order
from validation.contract.interface import States, Subject, Unsupported
from validation.contract.quantities import QUANTITIES, ROUNDING, TREE_QUANTITIES
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble

SETTINGS = Settings(states=20, engines=("lagrangian",))


def checked(system: sf.System, settings: Settings = SETTINGS) -> ModelResult:
    result = check(Subject(system.name, system), settings)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    return result


def rows(result: ModelResult, quantity: str) -> list[Any]:
    return [row for row in result.comparisons if row.quantity == quantity]


def beam(name: str, joint: sf.Joint, **more: Any) -> sf.Beam:
    stated: dict[str, Any] = {"EI_z": 3.0, "EI_y": 5.0, "GJ": 1.5, "rhoJ": 0.04, "bend_y": 1, "bend_z": 1, "twist": 1}
    return sf.Beam(name, joint, 1.3, 2.0, **(stated | {"retain": "all", "family": "legendre"} | more))


@pytest.mark.parametrize("name", sampled(tuple(RODS), ("in a plane, with bodies along it",)))
def test_geometrically_exact_rods_agree(name: str) -> None:
    checked(rod_system(name), replace(SETTINGS, states=10))


def test_every_kind_of_joint_agrees_with_pinocchio() -> None:
    """A beam without functions and without mass is on the tree, so that the engine takes it."""
    subject = every_kind()
    stub = sf.Beam("stub", sf.Joint("clamp", "fixed", "b5", "tip"), 0.1, 0.0)
    ours = lagrangian.build(replace(subject, system=subject.system.with_bodies(stub)))
    theirs = pinocchio.build(subject)
    assert not isinstance(ours, Unsupported) and not isinstance(theirs, Unsupported)
    states = states_of(subject, 20)
    scales = typical_scales(theirs, states)
    for name in TREE_QUANTITIES - {"gravity"}:
        quantity = QUANTITIES[name]
        errors = state_errors(quantity, getattr(ours, name)(states), getattr(theirs, name)(states), scales)
        assert errors.max() <= quantity.tolerance, name


@pytest.mark.parametrize("kind", sampled(("free", "ball", "universal", "cylindrical", "planar", "screw"), ["free"]))
def test_a_beam_on_every_kind_of_joint_agrees(kind: str) -> None:
    joint = sf.Joint("j", kind, position=(0.1, 0.2, 0.3), axis=(1, 2, 2), pitch=0.2)  # type: ignore[arg-type]
    load = sf.RigidBody("load", sf.Joint("elbow", "revolute", "b", "tip", axis=(0, 1, 0)), UNIT)
    checked(sf.System(kind, [beam("b", joint), load]))


@pytest.mark.parametrize(
    "family",
    sampled(("spline", "polynomial", "legendre", "clamped_free", "hermite"), ["spline"]),
)
def test_every_family_agrees_in_three_directions(family: str) -> None:
    joint = sf.Joint("j", "revolute", axis=(1, 2, 2))
    counts = {"bend_y": 2, "bend_z": 2, "twist": 1}
    checked(sf.System(family, [beam("b", joint, family=family, **counts)]))


@pytest.mark.parametrize("case", sampled(("user's own", "planar formulas", "planar samples"), ["user's own"]))
def test_functions_of_the_user_agree_to_rounding(case: str) -> None:
    """Interpolation of formulas and splines through samples cost no digits, of stiffness neither."""
    result = checked(CASES[case].system)
    for quantity in ("mass_matrix", "generalized_force"):
        (row,) = [row for row in rows(result, quantity) if row.engine == "lagrangian"]
        assert row.tolerance == ROUNDING and row.error is not None and row.error < 1e-13


def test_all_features_of_lagrangian_models_agree() -> None:
    """Bodies on root and tip, rotors, armature, springs, a general and a driven joint, loads by formula, a taper."""
    drive = sf.Joint("d", "revolute", axis=(0, 0, 1), prescribed=True)
    spring = (sf.Spring(20.0, 0.1, 3.0), sf.Damper(0.4), sf.Stop(50.0, 1.0, -0.2, 0.2))
    rotors = (sf.Rotor(0.01, 30.0), sf.Rotor(0.02, 9.0, (1.0, 0.5, 0.2), "one"))
    hinge = sf.Joint("h", "revolute", "base", axis=(0, 1, 1), elements=spring, rotors=rotors[:1], armature=0.3)
    wrist = sf.Joint(
        "w",
        "general",
        "one",
        "tip",
        coordinates=("X", "A"),
        moving_position=("X", "a*X^2", "sin(A)"),
        moving_rotation=sf.Rotation.axis_angle((1.0, 0.2, 0.3), "A"),
    )
    last = sf.Joint("l", "revolute", "tool", rotors=rotors[1:])
    load = sf.BeamLoad(("f*x", "dh", "cos(h)"))
    bodies = [
        sf.RigidBody("base", drive, UNIT),
        beam(
            "one",
            hinge,
            EI_z="3*(1 - x/3)^3",
            damping=0.01,
            loads=(load,),
            rotary_inertia=True,
            rhoI_y=0.02,
            rhoI_z=0.03,
        ),
        sf.RigidBody("collar", sf.Joint("c", "fixed", "one", None, (0.1, 0, 0)), UNIT),
        sf.RigidBody("head", sf.Joint("e", "fixed", "one", "tip", (0.1, 0.2, 0)), UNIT),
        sf.RigidBody("tool", wrist, UNIT),
        beam("two", last, foreshortening=False),
    ]
    result = checked(sf.System("rich", bodies, [sf.Parameter("a", 0.7)], [sf.Input("f")]))
    compared = {row.quantity for row in result.comparisons if row.engine == "lagrangian"}
    assert {"generalized_force", "potential_energy", "motion_energy"} <= compared


def test_lower_orders_are_tied_to_everything_kept_by_their_power() -> None:
    joint = sf.Joint("j", "revolute", axis=(1, 2, 2))
    for order, power in (("first_order", 2), ("zeroth_order", 1)):
        result = checked(sf.System("s", [beam("b", joint, retain=order)]))
        (row,) = rows(result, "retained_order")
        assert row.status == "agree" and row.extra["power"] == pytest.approx(power, abs=0.1)
        (drift,) = rows(result, "energy_drift")
        assert drift.status == "unsupported" and order.replace("_", " ") in drift.note
    result = checked(sf.System("s", [beam("b", joint)]))
    assert not rows(result, "retained_order")
    assert rows(result, "energy_drift")[0].status == "agree"


def test_a_lower_power_is_found() -> None:
    """A zeroth-order model that says it is of first order."""
    system = sf.System("s", [beam("b", sf.Joint("j", "revolute"), retain="zeroth_order")])
    ours, untruncated_model = (compiled.build(subject_of(s)) for s in (system, untruncated(system)))
    assembly = assemble(system)
    states = sample(assembly, 0, 20)
    assert judge_order("s", "first_order", assembly, ours, untruncated_model, states).status == "disagree"
    assert judge_order("s", "zeroth_order", assembly, ours, untruncated_model, states).status == "agree"


def test_models_outside_the_scope_of_the_engine_are_refused() -> None:
    built = lagrangian.build(floating_arm())
    assert isinstance(built, Unsupported) and built.reason.startswith("no beams")
    result = check(floating_arm(), Settings(states=5))
    assert not any(row.engine == "lagrangian" for row in result.comparisons)
    driven = sf.System("s", [beam("b", sf.Joint("j", "ball", prescribed=True))])
    (row,) = check(Subject("s", driven), SETTINGS).comparisons
    assert row.status == "failed" and "quaternion" in row.note


def test_forces_that_it_is_not_given_are_not_compared() -> None:
    loaded = sf.System(
        "s",
        [
            beam("b", sf.Joint("j", "revolute")),
            sf.RigidBody("m", sf.Joint("f", "fixed", "b", "tip"), UNIT, loads=(sf.Load((0, 1, 0)),)),
        ],
    )
    assert not [row for row in rows(checked(loaded), "generalized_force") if row.engine == "lagrangian"]


@pytest.mark.parametrize("retain", sampled(("all", "first_order"), ["all"]))
def test_moments_on_sections_are_compared(retain: Any) -> None:
    """At a station in the world's axes, and spread along the beam by a formula of the station."""
    loads = sf.BeamLoad(torque=(1, -2, 0.5), at=0.4, axes="world"), sf.BeamLoad(torque=("x", 1, "-x"))
    result = checked(sf.System("s", [beam("b", sf.Joint("j", "revolute"), loads=loads, retain=retain)]))
    (row,) = [row for row in rows(result, "generalized_force") if row.engine == "lagrangian"]
    assert row.status == "agree" and row.error is not None and row.error < 1e-12
    assert result.ok


def test_slow_derivations_use_few_states(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lagrangian, "MOST_COLUMNS", 44)
    result = checked(sf.System("s", [beam("b", sf.Joint("j", "revolute"))]))
    (row,) = rows(result, "bias")
    assert row.states == 11 and row.note.startswith("the first 11 of 20 states")
    assert np.isfinite(row.error)


def test_a_nan_in_the_truncated_model_disagrees() -> None:
    """Engines are compared with the model of every term, so this comparison alone sees the truncated one."""

    class NotANumber(SymofrosEngine):
        def mass_matrix(self, states: States) -> Any:
            return np.full_like(super().mass_matrix(states), np.nan)

    system = sf.System("s", [beam("b", sf.Joint("j", "revolute"), retain="first_order")])
    model = compiled.build(subject_of(untruncated(system)))
    row = judge_order(
        "s", "first_order", assemble(system), NotANumber(**vars(model)), model, sample(assemble(system), 0, 20)
    )
    assert row.status == "disagree" and "finite" in row.note
