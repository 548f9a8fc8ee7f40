"""Engine against engine, and ours against all."""

import pytest

import symofros as sf
from tests.models import sampled
from tests.validation.subjects import UNIT, every_kind, pendulum, states_of, subject_of, tree
from validation.adapters.exact import accelerations
from validation.adapters.pinocchio import tree as pinocchio
from validation.checking import Settings, check
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import CONSTRAINED, LOOPS, QUANTITIES
from validation.procedures.equations.derivatives import BY_ENGINES, QUESTIONS

FEW = Settings(states=40)


def test_engines_agree_with_the_truth_of_a_description() -> None:
    """One truth: of an engine's trees, and of a description in our coordinates."""
    subject, engine = every_kind(), pinocchio.build(every_kind())
    assert not isinstance(engine, Unsupported)
    states = states_of(subject)[-3:]
    for q, v, tau, found in zip(states.q, states.v, states.applied, engine.forward_dynamics(states), strict=True):
        true = accelerations(subject, q, v, tau)
        assert abs(found - true).max() < QUANTITIES["forward_dynamics"].tolerance * abs(true).max()


@pytest.mark.parametrize(
    "subject",
    [every_kind(), *(pytest.param(tree(seed), marks=pytest.mark.slow) for seed in (0, 3))],
    ids=lambda s: s.label,
)
def test_our_c_agrees_with_all(subject: Subject) -> None:
    result = check(subject, FEW)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    assert {row.engine for row in result.comparisons} >= {
        "pinocchio",
        "mujoco",
        "interpreted",
        "description",
        "symofros",
    }
    of_trees = {*QUANTITIES, "motion_energy", "energy_drift"} - CONSTRAINED - LOOPS
    # "all" is what stands for an engine that can't represent the model.
    compared = {row.quantity for row in result.comparisons if row.engine != "relations"}
    assert compared - {"all", *(one.name for one in QUESTIONS)} - BY_ENGINES.keys() == of_trees


def test_forces_are_the_stated_formulas() -> None:
    system = sf.System(
        "driven",
        [
            sf.RigidBody("a", sf.Joint("j", "revolute", effort=("-k*j - c*dj + 2*push^2",), actuated=True), UNIT),
            sf.RigidBody("b", sf.Joint("s", "ball", "a", effort=("-c*s.wx", "push", "k*s.qw"), actuated=True), UNIT),
        ],
        [sf.Parameter("k", 3.0), sf.Parameter("c", 0.5, constant=True)],
        [sf.Input("push")],
    )
    result = check(subject_of(system), FEW)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    row = next(row for row in result.comparisons if row.engine == "description")
    assert row.states == 40 and row.error is not None


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (0.0, 9.81, 0.0)])
def test_vanishing_quantities_agree(gravity: tuple[float, ...]) -> None:
    """Without gravity, or with gravity along the axis, bias and potential energy are zero or rounding."""
    result = check(subject_of(pendulum(gravity=gravity)), FEW)
    assert result.ok, [row for row in result.comparisons if not row.ok]


@pytest.mark.parametrize("tilt", sampled((1e-6, 1e-8, 1e-10), [1e-8]))
def test_slight_tilts_are_kept(tilt: float) -> None:
    """Cosines of small angles are 1 to rounding, the angles are not 0."""
    bodies, parent = [], "world"
    for i in range(3):
        rotation = sf.Rotation.rpy(tilt, tilt, 0.5)
        joint = sf.Joint(f"q{i}", "revolute", parent, None, (0.3, 0.1, 0.2), rotation, (0.0, 1.0, 0.0))
        bodies.append(sf.RigidBody(f"b{i}", joint, UNIT))
        parent = f"b{i}"
    result = check(subject_of(sf.System("tilted", bodies)), FEW)
    assert result.ok, [(row.engine, row.quantity, row.error) for row in result.comparisons if not row.ok]


@pytest.mark.parametrize(
    ("force", "word"),
    [
        ({"effort": ("-0.1*sign(dq)",)}, "sign"),
        ({"elements": (sf.Friction(0.1),)}, "friction"),
        ({"elements": (sf.Stop(100.0, upper=0.1),)}, "stop"),
        ({"elements": (sf.Damper(0.0, 0.1),)}, "damper"),
    ],
)
def test_force_discontinuities_are_not_reported_as_drift(force: dict[str, tuple[object, ...]], word: str) -> None:
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), **force)  # type: ignore[arg-type]
    result = check(subject_of(sf.System("dry", [sf.RigidBody("rod", joint, UNIT)])), FEW)
    (row,) = (row for row in result.comparisons if row.quantity == "energy_drift")
    assert row.status == "unsupported" and word in row.note
    assert result.ok
