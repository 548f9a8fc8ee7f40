"""Every fault of a description is found, named, explained; all of them together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.mechanics.topology.events import find_problems
from symofros.mechanics.topology.graph import check

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


def winch(**cable: Any) -> sf.System:
    """A free body below a point 2 m up, and what is between them."""
    bob = sf.RigidBody(
        "bob", sf.Joint("m", "free"), sf.Inertia(3.0, moments=(0.1, 0.1, 0.1)), loads=cable.pop("loads", ())
    )
    base = sf.RigidBody("base", None, None, [sf.Frame("top", (0, 0, 2))])
    return sf.System("winch", [base, bob], [sf.Parameter("k", 1e4)], [sf.Input("length")], **cable)


def test_a_cable_with_changing_length_is_refused_with_the_remedy() -> None:
    cable = sf.Connection("cable", ("base", "top"), ("bob", None), stiffness="k", length="length")
    problem = only(winch(connections=[cable]))
    assert "cable" in problem.what and "'length' may not be used here" in problem.what
    assert "max(0, k*(d - length))" in problem.remedy and "virtual power" in problem.remedy


@pytest.mark.parametrize("length", [1.0, 2.0])
def test_the_proposed_formulas_for_a_winch_cable_pull_and_do_not_push(length: float) -> None:
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


def test_names_that_appear_twice_are_refused() -> None:
    twice = sf.System("s", [body("a", sf.Joint("q", "revolute")), body("a", sf.Joint("q", "revolute"))])
    text = "\n".join(problem.what for problem in find_problems(twice))
    assert "body 'a' appears 2 times" in text and "joint 'q' appears 2 times" in text
    frames = arm().with_bodies(body("arm2", frames=[sf.Frame("f"), sf.Frame("f")]))
    assert "frame 'f' appears 2 times on body 'arm2'" in only(frames).what


@pytest.mark.parametrize("name", ["sin", "t", "pi", "my input", "a-b", "1", "ü"])
def test_inputs_and_joints_may_have_any_printable_name(name: str) -> None:
    assert find_problems(arm(inputs=[sf.Input(name)])) == []
    assert find_problems(arm().with_bodies(body("hand", sf.Joint(name, "revolute")))) == []
    assert "the name" in only(arm(inputs=[sf.Input(name)]).with_bodies(body("hand", sf.Joint(name, "revolute")))).what


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


def test_references_to_unreadable_elements_are_not_reported_again() -> None:
    stated = arm().with_bodies(body("hand", sf.Joint("q3", "revolute", "wrist"), sf.Inertia("m_hand")))
    assert len(find_problems(stated)) == 2
    assert find_problems(stated, broken={"wrist", "m_hand"}) == []
