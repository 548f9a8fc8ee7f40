"""Every fault of a description is found, named, explained; all of them together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.mechanics.topology.graph import check, find_problems

SOLID = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))


def arm(**changes: object) -> sf.System:
    """A sound two-body arm, with fields of the system replaced."""
    one = sf.RigidBody("arm1", sf.Joint("q1", "revolute"), SOLID, [sf.Frame("tip", ("L1", 0, 0))])
    two = sf.RigidBody("arm2", sf.Joint("q2", "revolute", "arm1", "tip"), SOLID)
    stated: dict[str, object] = {"name": "arm", "bodies": [one, two], "parameters": [sf.Parameter("L1", 1.0)]}
    return sf.System(**(stated | changes))  # type: ignore[arg-type]


def only(system: sf.System) -> sf.Problem:
    problems = find_problems(system)
    assert len(problems) == 1, "\n".join(map(str, problems))
    return problems[0]


def body(name: str = "x", joint: sf.Joint | None = None, inertia: sf.Inertia | None = SOLID, **more: object):  # type: ignore[no-untyped-def]
    return sf.RigidBody(name, joint or sf.Joint(f"q_{name}", "revolute"), inertia, **more)  # type: ignore[arg-type]


def test_a_sound_system_has_no_problems() -> None:
    assert find_problems(arm()) == []


def test_a_long_cycle_is_named_in_short() -> None:
    names = [f"b{i}" for i in range(500)]
    bodies = [body(name, sf.Joint(f"q{name}", "revolute", names[i - 1])) for i, name in enumerate(names)]
    problem = only(sf.System("loop", bodies))
    assert "500 bodies" in problem.found and len(str(problem)) < 1000


def test_a_body_that_carries_itself_is_refused() -> None:
    problem = only(sf.System("self", [body("a", sf.Joint("qa", "revolute", "a"))]))
    assert "a -> a" in problem.what


@pytest.mark.parametrize(
    ("inertia", "found"),
    [
        (sf.Inertia(-1.0), "mass -1"),
        (sf.Inertia(1.0, (0, 0, 0), (1, 1, 3)), "the largest exceeds the sum"),
        (sf.Inertia(1.0, (0, 0, 0), (1, -1, 1)), "one is negative"),
        (sf.Inertia(1.0, (0, 0, 0), (1, 1, 1, 5, 0, 0)), "one is negative"),
        (sf.Inertia(1.0, (2, 0, 0), (1, 1, 1), about="body"), "one is negative"),
        (sf.Inertia(0.0, (0, 0, 0), (1, 1, 1)), "without mass"),
    ],
)
def test_non_physical_inertia_is_refused_unless_waived(inertia: sf.Inertia, found: str) -> None:
    problem = only(arm().with_bodies(body("arm2", inertia=inertia)))
    assert "non-physical inertia" in problem.what and found in problem.found and "waive" in problem.remedy
    assert find_problems(arm().with_bodies(body("arm2", inertia=inertia, waive=["nonphysical_inertia"]))) == []


def test_thin_bodies_are_physical() -> None:
    rod = sf.Inertia(1.0, (0.5, 0, 0), (0.0, 1 / 12, 1 / 12))
    plate = sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 2.0))
    assert find_problems(arm().with_bodies(body("r", inertia=rod), body("p", inertia=plate))) == []


def test_a_joint_that_moves_no_mass_is_refused() -> None:
    problem = only(arm().with_bodies(body("finger", inertia=None)))
    assert "moves no mass" in problem.what and "waive: [massless_tip]" in problem.remedy
    carried = arm().with_bodies(body("wrist", inertia=None), body("hand", sf.Joint("qh", "revolute", "wrist")))
    assert find_problems(carried) == []


def winch(**cable: Any) -> sf.System:
    """A free body below a point 2 m up, and what is between them."""
    bob = sf.RigidBody(
        "bob", sf.Joint("m", "free"), sf.Inertia(3.0, moments=(0.1, 0.1, 0.1)), loads=cable.pop("loads", ())
    )
    base = sf.RigidBody("base", None, None, [sf.Frame("top", (0, 0, 2))])
    return sf.System("winch", [base, bob], [sf.Parameter("k", 1e4)], [sf.Input("length")], **cable)


def test_a_cable_that_a_winch_draws_in_is_refused_with_what_states_it() -> None:
    cable = sf.Connection("cable", ("base", "top"), ("bob", None), stiffness="k", length="length")
    problem = only(winch(connections=[cable]))
    assert "cable" in problem.what and "'length' may not be used here" in problem.what
    assert "max(0, k*(d - length))" in problem.remedy and "virtual power" in problem.remedy


@pytest.mark.parametrize("length", [1.0, 2.0])
def test_that_remedy_pulls_and_does_not_push(length: float) -> None:
    """As a load on a free body, and as virtual power on a slide 1 m beside the winch."""
    d = "sqrt(m.px^2 + m.py^2 + (m.pz - 2)^2)"
    pull = f"max(0, k*({d} - length))/{d}"
    load = sf.Load((f"-{pull}*m.px", f"-{pull}*m.py", f"-{pull}*(m.pz - 2)"), axes="world")
    m = sf.compile(winch(loads=[load]), sf.Options(backend="interpreter"))
    line = np.array([0.3, 0.0, -1.5])
    distance = float(np.linalg.norm(line))
    Q = m.generalized_force([0.3, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0], np.zeros(6), [length])
    right = -1e4 * max(0.0, distance - length) / distance * line
    np.testing.assert_allclose(Q, [*right, 0.0, 0.0, 0.0], rtol=1e-12, atol=1e-9)

    power = sf.VirtualPower("cable", {"dx": "-max(0, k*(sqrt(x^2 + 1) - length))*x/sqrt(x^2 + 1)"})
    slide = sf.RigidBody("slide", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(3.0))
    system = sf.System("s", [slide], [sf.Parameter("k", 1e4)], [sf.Input("length")], virtual_power=[power])
    Q = sf.compile(system, sf.Options(backend="interpreter")).generalized_force([1.2], [0.0], [length])
    distance = float(np.hypot(1.2, 1.0))
    np.testing.assert_allclose(Q, [-1e4 * max(0.0, distance - length) * 1.2 / distance], rtol=1e-12, atol=1e-9)


def test_efforts_may_use_the_state() -> None:
    spring = body("arm2", sf.Joint("q2", "revolute", "arm1", effort=("-L1*q2 - 0.1*dq2 + u1*sin(t)",)))
    assert find_problems(arm(inputs=[sf.Input("u1")]).with_bodies(spring)) == []


def test_names_that_appear_twice_are_refused() -> None:
    twice = sf.System("s", [body("a", sf.Joint("q", "revolute")), body("a", sf.Joint("q", "revolute"))])
    text = "\n".join(problem.what for problem in find_problems(twice))
    assert "body 'a' appears 2 times" in text and "joint 'q' appears 2 times" in text
    frames = arm().with_bodies(body("arm2", frames=[sf.Frame("f"), sf.Frame("f")]))
    assert "frame 'f' appears 2 times on body 'arm2'" in only(frames).what


@pytest.mark.parametrize(("name", "found"), [("t", "the time"), ("pi", "a constant"), ("L1", "a parameter")])
def test_reserved_and_taken_names_are_refused(name: str, found: str) -> None:
    parameters = [sf.Parameter("L1", 1.0), *([sf.Parameter(name, 1.0)] if name != "L1" else [])]
    problem = only(arm(parameters=parameters, inputs=[sf.Input("L1")] if name == "L1" else []))
    assert "the name is taken" in problem.what and found in problem.found


@pytest.mark.parametrize("name", ["sin", "t", "pi", "my input", "a-b", "1", "ü"])
def test_inputs_and_joints_bear_any_printable_name(name: str) -> None:
    assert find_problems(arm(inputs=[sf.Input(name)])) == []
    assert find_problems(arm().with_bodies(body("hand", sf.Joint(name, "revolute")))) == []
    assert "the name" in only(arm(inputs=[sf.Input(name)]).with_bodies(body("hand", sf.Joint(name, "revolute")))).what


def test_names_that_cannot_be_printed_are_refused() -> None:
    assert "input with an unusable name" in only(arm(inputs=[sf.Input("my\ninput")])).what
    assert "unusable name" in only(arm().with_bodies(body("a\nb", sf.Joint("qa", "revolute")))).what


def test_coordinates_and_parameters_share_their_names() -> None:
    problem = only(arm(parameters=[sf.Parameter("L1", 1.0), sf.Parameter("dq1", 1.0)]))
    assert "joint 'q1': the name of its speed is taken" in problem.what


def test_two_joints_of_one_name_are_told_apart_once() -> None:
    system = arm(parameters=[sf.Parameter("L1", 1.0), sf.Parameter("q2", 1.0)]).with_bodies(
        body("hand", sf.Joint("q2", "revolute"))
    )
    twice, taken = find_problems(system)
    assert "'arm2', 'hand'" in twice.found and "name of its coordinate is taken" in taken.what


@pytest.mark.parametrize("rotation", [("1e300*1e300", 0, 0), ("log(-1)", 0, 0)])
def test_a_rotation_by_no_finite_angle_is_refused(rotation: tuple[str, int, int]) -> None:
    joint = sf.Joint("q3", "revolute", rotation=sf.Rotation("rpy", rotation))
    assert "not a finite number" in only(arm().with_bodies(body("hand", joint))).what


@pytest.mark.parametrize("size", [0.0, 1e308])
def test_directions_without_length_are_refused(size: float) -> None:
    """Zero, or so long that the length overflows."""
    axis = (size, size, size)
    assert "has no direction" in only(arm().with_bodies(body("b", sf.Joint("q3", "revolute", axis=axis)))).what


def test_values_that_are_not_finite() -> None:
    stated = arm(parameters=[sf.Parameter("L1", 0.0)]).with_bodies(
        body("arm2", inertia=sf.Inertia("1/L1", (0, 0, 0), (1, 1, 1)))
    )
    assert "not a finite number at the parameters' values" in only(stated).what


@pytest.mark.parametrize(
    ("rotation", "what"),
    [
        (sf.Rotation.matrix([[1, 0, 0], [0, 1, 0], [0, 0, -1]]), "not a rotation"),
        (sf.Rotation.matrix([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]), "not a rotation"),
        (sf.Rotation.quaternion(0, 0, 0, 0), "no direction"),
        (sf.Rotation.axis_angle((0, 0, 0), 1.0), "no direction"),
    ],
)
def test_rotations_that_are_none(rotation: sf.Rotation, what: str) -> None:
    assert what in only(arm().with_bodies(body("arm2", frames=[sf.Frame("f", rotation=rotation)]))).what


def test_efforts_fit_the_joint() -> None:
    problem = only(arm().with_bodies(body("arm2", sf.Joint("q2", "ball", effort=("1", "2")))))
    assert "2 efforts" in problem.found and "3 speeds" in problem.rule


def test_lower_limits_lie_below_upper_ones() -> None:
    crossed = body("arm2", sf.Joint("q2", "revolute", limits=sf.Limits(1.0, -1.0)))
    assert "limits crossed" in only(arm().with_bodies(crossed)).what


def test_a_system_in_which_nothing_moves_is_refused() -> None:
    assert "nothing moves" in only(sf.System("stone", [sf.RigidBody("ground")])).what


def test_all_problems_are_reported_together() -> None:
    stated = arm(inputs=[sf.Input("L1")]).with_bodies(
        body("arm2", sf.Joint("q2", "revolute", "arm1", "tipp"), sf.Inertia("m9")),
        body("hand", sf.Joint("q3", "revolute", "nobody")),
        body("fat", inertia=sf.Inertia(-2.0)),
        sf.RigidBody("g1"),
        sf.RigidBody("g2"),
    )
    with pytest.raises(sf.DescriptionError) as caught:
        check(stated)
    text = str(caught.value)
    assert len(caught.value.problems) == 6
    for part in ("taken", "tipp", "m9", "disconnected", "two bases", "mass -2"):
        assert part in text


def test_errors_cross_processes() -> None:
    import pickle

    error = sf.DescriptionError(find_problems(arm(inputs=[sf.Input("L1")])))
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems and str(again) == str(error)


def test_references_to_what_could_not_be_read_are_not_reported_again() -> None:
    stated = arm().with_bodies(body("hand", sf.Joint("q3", "revolute", "wrist"), sf.Inertia("m_hand")))
    assert len(find_problems(stated)) == 2
    assert find_problems(stated, broken={"wrist", "m_hand"}) == []
