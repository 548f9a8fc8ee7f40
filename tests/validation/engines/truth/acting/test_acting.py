"""Steps, forces of a tree's own, sensors: the truth against what defines it, and engines by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.late import needs_extra
from validation.engines.causes.cause import stated
from validation.engines.functions import STEPS
from validation.engines.interface import ORIGIN, STEP, Actuator, End, Tree, Unsupported
from validation.engines.matrix import SEED, Judged, Truths, asked, cells, judged
from validation.engines.models import acting, sensed
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import taken
from validation.engines.proving.shrink import Case, smallest
from validation.engines.truth.arithmetic import Exact
from validation.engines.truth.dynamics import Point, Truth, digits
from validation.engines.verdicts import judge
from validation.engines.workers import Job, answered

TREES = acting.trees()
SENSED = sensed.trees()
# (engine, tree, a step that is asked for, one that leaves out what the tree is about).
FAULTS = [
    ("mujoco", "dampers on hinges", "step_dampers_implicit", "step_semi_implicit"),
    ("mujoco", "springs on hinges", "step_stiffness_implicit_lone", "step_forces_implicit"),
    ("mujoco", "servos of position and velocity", "step_forces_implicit", "step_dampers_implicit"),
    ("mujoco", "a damped free body", "step_velocities_implicit", "step_dampers_implicit"),
    ("exudyn", "dampers on hinges", "step_rk4", "step_midpoint"),
    (
        *("mujoco", "tendon of a sum of the first and the last of three joints"),
        *("step_velocities_implicit:sparse", "step_semi_implicit"),
    ),
    ("mujoco", "servos along joints", "step_forces_implicit", "step_semi_implicit"),
    ("mujoco", "affine gains of activations", "step_forces_implicit", "step_dampers_implicit"),
    ("mujoco", "servos against the order of joints", "step_velocities_implicit", "step_dampers_implicit"),
]


def _judged(engine: str, tree: Tree, *functions: str) -> dict[str, Judged]:
    job = Job(engine, tree, tuple(functions), SEED)
    return {one.cell.function: one for one in judged(OWN[engine], job, Truths())}


def _truth(tree: Tree) -> tuple[Truth, Point]:
    (answer,) = answered(Job("mujoco", tree, ("sizes",), SEED))
    assert answer.layout is not None and answer.state is not None
    return Truth(tree, answer.layout), Point.of(answer.state)


# Of MuJoCo: joints of one speed, exact filters alone, no tendons with armature.
_NOT_OF_ALL = {
    ("actuated_forces:jointactuatorfrc", "not offered"),
    ("activations_after_step:RK4", "not offered"),
    ("mass_matrix:mj_crb", "precondition"),
}


@pytest.mark.parametrize("engine", ["mujoco", "exudyn"])
@pytest.mark.parametrize("name", TREES)
def test_engines_are_right_about_trees_that_forces_act_on(engine: str, name: str) -> None:
    found = [cell for cell in cells(OWN[engine], TREES[name]) if not any(one.explains(cell) for one in stated())]
    verdicts = {cell.function: cell.verdict for cell in found}
    others = {(function, verdict) for function, verdict in verdicts.items() if verdict != "right"}
    if engine == "exudyn":
        assert {verdict for _, verdict in others} <= {"not offered"}
    else:
        assert others <= _NOT_OF_ALL


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
@pytest.mark.parametrize("name", SENSED)
def test_sensors_read_what_they_document(engine: str, name: str) -> None:
    tree = SENSED[name]
    verdicts = {cell.function: cell.verdict for cell in cells(OWN[engine], tree)}
    assert not asked(OWN[engine], tree) or {"accelerometers", "gyroscopes"} <= set(verdicts)
    assert set(verdicts.values()) <= {"right", "not offered"}


def test_drake_is_asked_for_relative_velocities_of_frames() -> None:
    pytest.importorskip("pydrake", reason=needs_extra("engine-drake", "pydrake"))
    (cell,) = cells(OWN["drake"], SENSED["sensors on hinges"], ("frame_velocities:CalcRelativeSpatialVelocity",))
    assert cell.verdict == "right"


def test_a_sensor_that_forgets_where_it_stands_is_a_red_cell() -> None:
    names = ("accelerometers", "velocimeters", "wrench_sensors", "gyroscopes")
    tree = SENSED["sensors on hinges"]
    at_origins = replace(tree, sensors=tuple(end._replace(p=ORIGIN) for end in tree.sensors))
    want, given = (_judged("mujoco", one, *names) for one in (tree, at_origins))
    verdicts = []
    for name in names:
        expected = want[name].want
        assert expected is not None
        verdicts.append(judge("planted", tree, name, np.asarray(given[name].answer.value), expected).verdict)
    assert verdicts == ["wrong", "wrong", "wrong", "right"]


@pytest.mark.parametrize("name", ["sensors on damped hinges", "sensors on driven joints"])
def test_a_wrench_without_the_share_of_the_joint_is_a_red_cell(name: str) -> None:
    """What a damper or a motor does is part of what holds a link; along a free hinge there would be nothing."""
    tree = SENSED[name]
    bare = replace(
        tree,
        actuators=(),
        links=tuple(replace(one, joints=(replace(one.joints[0], damping=0.0),)) for one in tree.links),
    )
    (wanted,), (given,) = (_judged("mujoco", one, "wrench_sensors_driven").values() for one in (tree, bare))
    assert wanted.want is not None and wanted.cell.verdict == given.cell.verdict == "right"
    answer = np.asarray(given.answer.value)
    assert judge("planted", tree, "wrench_sensors_driven", answer, wanted.want).verdict == "wrong"


_PULLING = Actuator(tendon=0, gear=2.0, gain=1.5, bias=(0.25, -3.0, -0.5), control=0.75)


@pytest.mark.parametrize("actuators", [(), (_PULLING,)])
@pytest.mark.parametrize(
    "name", ["sensors on hinges that a tendon pulls", "sensors on hinges that a tendon over points pulls"]
)
def test_holding_wrenches_balance_a_tendon_between_links(name: str, actuators: tuple[Actuator, ...]) -> None:
    """And what an actuator pulls the tendon with."""
    tree = replace(SENSED[name], actuators=actuators)
    (wanted,), (bare,) = (
        _judged("mujoco", one, "wrench_sensors").values() for one in (tree, replace(tree, tendons=(), actuators=()))
    )
    assert wanted.cell.verdict == bare.cell.verdict == "right" and wanted.want is not None
    answer = np.asarray(bare.answer.value)
    assert judge("planted", tree, "wrench_sensors", answer, wanted.want).verdict == "wrong"


def test_holding_wrenches_of_links_in_wrapped_tendons_are_refused() -> None:
    wrapped = next(one for one in acting.passive().values() if any(tendon.wraps for tendon in one.tendons))
    tree = replace(wrapped, sensors=(End(wrapped.links[0].name),))
    (cell,) = cells(OWN["mujoco"], tree, ("wrench_sensors",))
    assert cell.verdict == "plug-in" and "wraps around" in cell.words


@pytest.mark.parametrize("reading", ["accelerometers", "angular_accelerations", "wrench_sensors"])
def test_a_reading_that_keeps_the_forces_of_before_is_a_red_cell(reading: str) -> None:
    ways = [f"{reading}_driven", f"{reading}_driven:mj_step2 again"]
    one, again = (_judged("mujoco", SENSED["sensors on hinges"], way)[way] for way in ways)
    assert one.want is not None and one.cell.verdict == again.cell.verdict == "right"
    plugin, state = OWN["mujoco"], one.answer.state
    assert state is not None
    model = plugin.build(SENSED["sensors on hinges"])
    assert not isinstance(model, Unsupported)
    stale = model.call(ways[0], replace(state, tau=state.a))
    assert judge("planted", SENSED["sensors on hinges"], ways[0], np.asarray(stale), one.want).verdict == "wrong"


@pytest.mark.parametrize("kind", ["revolute oblique", "ball", "free", "three hinges"])
def test_mujoco_steps_as_it_documents(kind: str) -> None:
    others = ("_control_derivative", "velocities_implicit_derivative", "forces_implicit_derivative")
    names = [name for name in OWN["mujoco"].functions if name in STEPS and not name.endswith(others)]
    assert {cell.verdict for cell in cells(OWN["mujoco"], tree_of(kind), names)} == {"right"}


@pytest.mark.parametrize(("engine", "name", "asked_for", "given"), FAULTS)
def test_a_step_that_leaves_a_part_out_is_a_red_cell(engine: str, name: str, asked_for: str, given: str) -> None:
    steps = _judged(engine, TREES[name], asked_for, given)
    want = steps[asked_for].want
    assert want is not None
    cell = judge("planted", TREES[name], asked_for, np.asarray(steps[given].answer.value), want)
    assert cell.verdict == "wrong"


@pytest.mark.parametrize("name", [name for name in TREES if name.startswith("affine gains") and "limits" not in name])
def test_implicit_terms_of_a_step_are_the_derivative_of_forces(name: str) -> None:
    truth, s = _truth(TREES[name])

    def excess(t: Truth, s: Point) -> Exact:
        D, K = t.own.metrics(s.q, s.v)
        by_q = t.kinematics.tangent(lambda q: t.own.applied(q, s.v), s.q)
        return np.concatenate([D + t.along_speeds(lambda v: t.own.applied(s.q, v), s.v), K + by_q])

    assert np.max(np.abs(digits(truth.value(excess, s)))) < 1e-30


def test_a_step_changes_with_forces_as_its_implicit_terms_have_it() -> None:
    """Of a servo along a hinge dv+ = h / (M + h d + h^2 p) dtau, and dq+ = h dv+."""
    tree = TREES["servo along a hinge"]
    (servo,), function = tree.actuators, STEPS["step_stiffness_implicit_straight_force_derivative"]
    truth, s = _truth(tree)
    M = float(digits(truth.value(lambda t, s: t.M(s.q), s))[0, 0])
    damping = tree.links[-1].joints[0].damping - servo.bias[2]
    slope = STEP / (M + STEP * damping - STEP * STEP * servo.bias[1])
    np.testing.assert_allclose(digits(truth.value(function.truth, s)).ravel(), [STEP * slope, slope], rtol=1e-13)
    ends = STEPS["step_stiffness_implicit_straight_derivative"].truth
    (_, by_v), (_, v_by_v) = digits(truth.value(ends, s))
    assert v_by_v < 1.0 and by_v == pytest.approx(STEP * v_by_v, rel=1e-13)


CONTROLLED = ["affine gains", "muscles", "actuators clamped at their joints", "actuators at their limits"]


@pytest.mark.parametrize("name", [*CONTROLLED, "actuators disabled", "actuators on tendons"])
def test_the_effect_of_controls_is_the_difference_of_forces(name: str) -> None:
    tree = TREES[name]

    def moved(number: int, by: float) -> Tree:
        one = tree.actuators[number]
        muscle = one.muscle._replace(activation=one.muscle.activation + by) if one.muscle else None
        changed = replace(one, control=one.control + by, muscle=muscle)
        return replace(tree, actuators=(*tree.actuators[:number], changed, *tree.actuators[number + 1 :]))

    # A power of two, so that controls stay exact; forces are piecewise linear in controls.
    step, truth = 2.0**-20, _truth(tree)
    t, s = truth
    columns = []
    for number in range(len(tree.actuators)):
        ends = [_truth(moved(number, by))[0] for by in (-step, step)]
        before, after = (digits(one.value(lambda t, s: t.own.actuated(s.q, s.v), s)) for one in ends)
        columns.append((after - before) / (2.0 * step))
    want = digits(t.value(lambda t, s: t.own.by_controls(s.q, s.v), s))
    np.testing.assert_allclose(np.array(columns).T, want, atol=1e-9)


@pytest.mark.parametrize("name", CONTROLLED)
def test_a_control_that_acts_beyond_its_limits_is_a_red_cell(name: str) -> None:
    """The derivatives of the same actuators without limits, or of other gains."""
    tree, function = TREES[name], "step_dampers_implicit_control_derivative"
    joints = tuple(replace(link, joints=(replace(link.joints[0], force_limits=()),)) for link in tree.links)
    loose = tuple(replace(one, control_limits=(), force_limits=(), gain=2.0 * one.gain) for one in tree.actuators)
    free = tuple(
        replace(one, muscle=one.muscle._replace(peak=2.0 * one.muscle.peak)) if one.muscle else one for one in loose
    )
    (one,), (other,) = (
        _judged("mujoco", at, function).values() for at in (tree, replace(tree, links=joints, actuators=free))
    )
    assert one.want is not None and one.cell.verdict == other.cell.verdict == "right"
    assert judge("planted", tree, function, np.asarray(other.answer.value), one.want).verdict == "wrong"


def test_a_state_of_another_actuator_is_a_red_cell() -> None:
    tree = TREES["affine gains of activations before a motor"]
    first, second, *others = tree.actuators
    assert first.activation and second.activation
    swapped = (
        replace(first, activation=first.activation._replace(state=second.activation.state)),
        replace(second, activation=second.activation._replace(state=first.activation.state)),
        *others,
    )
    (one,), (other,) = (
        _judged("mujoco", at, "step_forces_implicit").values() for at in (tree, replace(tree, actuators=swapped))
    )
    assert one.want is not None and one.cell.verdict == other.cell.verdict == "right"
    answer = np.asarray(other.answer.value)
    assert judge("planted", tree, "step_forces_implicit", answer, one.want).verdict == "wrong"


@pytest.mark.parametrize("name", ["actuators on tendons", "tendon over points"])
def test_moment_arms_are_the_derivatives_of_lengths(name: str) -> None:
    truth, s = _truth(TREES[name])

    def excess(t: Truth, s: Point) -> Exact:
        lengths = t.kinematics.tangent(lambda q: np.array([length for length, _ in t.own.lines(q)]), s.q)
        return lengths - np.array([arms for _, arms in t.own.lines(s.q)])

    assert np.max(np.abs(digits(truth.value(excess, s)))) < 1e-30


@pytest.mark.parametrize("name", ["springs and dampers on hinges and a slide", "tendon over points", "tendon of a sum"])
def test_energy_of_springs_is_the_work_against_their_forces(name: str) -> None:
    truth, s = _truth(TREES[name])

    def excess(t: Truth, s: Point) -> Exact:
        slope = t.kinematics.tangent(lambda q: np.array([t.V(q)], dtype=object), s.q)[0]
        return slope - (t.g(s.q) - t.own.passive(s.q, 0 * s.v))

    assert np.max(np.abs(digits(truth.value(excess, s)))) < 1e-30
    one = _judged("mujoco", TREES[name], "potential_energy")["potential_energy"]
    bare = float(digits(truth.value(lambda t, s: np.array([t.V(s.q) - t.own.stored(s.q)], dtype=object), s))[0])
    assert one.want is not None and one.cell.verdict == "right"
    assert judge("planted", TREES[name], "potential_energy", np.array(bare), one.want).verdict == "wrong"


def test_methods_of_order_four_agree_to_that_order_in_coordinates_and_on_their_manifold() -> None:
    truth, s = _truth(tree_of("ball"))
    one, other = (truth.value(STEPS[name].truth, s) for name in ("step_rk4", "step_rk4_manifold"))
    assert 0.0 < np.max(np.abs(digits(one - other))) < 10 * STEP**5


@pytest.mark.parametrize(
    ("name", "other", "function"),
    [
        ("actuators with filters", "actuators of all kinds", "actuated_forces"),
        ("actuators with filters with actearly", "actuators with filters", "actuated_forces"),
        ("actuators with exact filters faster than a step", "actuators with filters", "activations_after_step"),
        ("actuators with exact filters", "actuators with filters", "activations_after_step"),
        ("actuators with filters at their limits", "actuators with filters", "activations_after_step"),
        ("actuators with filters", "actuators with integrators", "activation_rates"),
    ],
)
def test_a_state_of_actuators_of_another_rule_is_a_red_cell(name: str, other: str, function: str) -> None:
    right = _judged("mujoco", TREES[name], function)[function]
    assert right.want is not None and right.cell.verdict == "right"
    given = np.asarray(_judged("mujoco", TREES[other], function)[function].answer.value)
    assert judge("planted", TREES[name], function, given, right.want).verdict == "wrong"


@pytest.mark.parametrize("name", ["actuators with exact filters", "actuators with exact filters faster than a step"])
def test_runge_kutta_steps_of_exact_filters_are_a_fault_with_its_cause(name: str) -> None:
    """The stated cause: the filter's factor is taken of the mean rate; Euler's is of the rate at the start."""
    asked_for = ("activations_after_step", "activations_after_step:RK4")
    right, wrong = cells(OWN["mujoco"], TREES[name], asked_for)
    assert (right.verdict, wrong.verdict) == ("right", "wrong")
    assert [cause.name for cause in stated() if cause.explains(wrong)] == ["exact filters in Runge-Kutta steps"]


@pytest.mark.parametrize("name", ["actuators with filters", "actuators with states and without"])
def test_runge_kutta_steps_of_other_states_are_not_asked(name: str) -> None:
    (cell,) = cells(OWN["mujoco"], TREES[name], ("activations_after_step:RK4",))
    assert cell.verdict == "not offered"


def test_activations_of_muscles_rise_and_fall_at_their_own_rates() -> None:
    """T0 (1/2 + 3/2 w) as they rise, T1 / (1/2 + 3/2 w) as they fall; controls beyond 1 count as 1."""
    tree = TREES["muscles with activations"]
    (one,) = _judged("mujoco", tree, "activation_rates").values()
    slower = 0.5 + 1.5 * 0.375
    rates = [0.375 / (0.0625 * slower), -0.25 / (0.25 / slower), 0.625 / (0.0625 * slower)]
    assert one.want is not None
    np.testing.assert_allclose(one.want.value, rates, rtol=1e-14)


def test_an_engine_is_asked_for_no_forces_that_it_does_not_know() -> None:
    assert not {"step_rk4_manifold", "forward_dynamics_dq"} & set(asked(OWN["mujoco"], TREES["actuators with filters"]))
    assert asked(OWN["pinocchio"], TREES["motors"]) == ()
    assert "tendon_arms" not in asked(OWN["mujoco"], TREES["motors"])
    assert not {"passive_forces", "actuator_forces"} & set(asked(OWN["mujoco"], tree_of("ball")))


def test_a_fault_of_forces_is_shrunk_to_the_part_that_shows_it() -> None:
    tree = TREES["springs and dampers on branches"]
    (answer,) = answered(Job("mujoco", tree, ("sizes",), SEED))
    assert answer.layout is not None and answer.state is not None
    case = Case(tree, taken(answer.layout, answer.state))
    least = smallest(case, lambda one: any(joint.damping for link in one.tree.links for joint in link.joints))
    assert len(least.tree.links) == 1 and least.tree.forces == {"dampers"}
