"""Assembly: loops close near the guess, what is held stays, what can't close is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess, stewart_guess
from tests.models import compiled

FUNCTIONS = sf.Options(
    functions=("constraint", "constraint_rate", "constraint_jacobian", "constraint_bias", "frame_pose")
)
GUESSES = {
    "four_bar": [1.2, -1.0, 1.3],
    "slider_crank": [0.5, -0.7, 0.4],
    "parallelogram": [1.0, -0.9, 1.1, 1.0],
    "bricard": [0.1, -0.1, 0.1, -0.1, 0.1],
    "stewart": stewart_guess(),
    "delta": delta_guess(),
}


@pytest.mark.parametrize("name", GUESSES)
def test_loops_close(name: str) -> None:
    m = sf.compile(MODELS[name], FUNCTIONS)
    wished = np.random.default_rng(0).normal(size=m.nv)
    found = sf.assemble(m, GUESSES[name], wished)
    assert np.abs(m.constraint(found.q)).max() <= 1e-12 and np.abs(m.constraint_rate(found.q, found.v)).max() < 1e-10
    # Speeds change by the least that is needed: the change has no part along motions that the constraints allow.
    G = m.constraint_jacobian(found.q)
    change = found.v - wished
    assert np.linalg.norm(change - np.linalg.pinv(G, rcond=1e-8) @ (G @ change)) < 1e-9 * np.linalg.norm(wished)


@pytest.mark.parametrize("size", [10.0**exponent for exponent in range(-6, 9)])
def test_loops_of_all_sizes_close(size: float) -> None:
    m = sf.compile(MODELS["slider_crank"], FUNCTIONS)
    m = m.with_parameters(L1=0.15 * size, L2=0.3 * size)
    for turn in (0.5, 1.3, 2.0, -2.8):
        closed = sf.assemble(m, [turn, -0.5 * turn, 0.3 * size], [1.0, 0.0, 0.0], held=["turn"])
        assert np.abs(m.constraint(closed.q)).max() <= max(1e-12 * min(1e3 * size, 1.0), 1e-14 * size)
        assert np.abs(m.constraint_rate(closed.q, closed.v)).max() <= 1e-12 * size


def test_what_is_held_stays() -> None:
    m = sf.compile(MODELS["four_bar"], FUNCTIONS)
    found = sf.assemble(m, [1.2, -1.0, 1.3], [2.0, 0.0, 0.0], held=["q1"])
    assert found.q[0] == 1.2 and found.v[0] == 2.0 and found.v[2] == pytest.approx(2.0)


def loop_in_line(lengths: tuple[float, ...], ground: float) -> sf.System:
    """A planar loop as it is drawn, its links in one line: a chain, and its last link on a pivot of its own."""
    bodies: list[sf.RigidBody] = []
    for i, length in enumerate(lengths):
        last = i == len(lengths) - 1
        place = {"position": (ground, 0, 0)} if last else {"parent": f"b{i - 1}", "frame": "end"} if i else {}
        inertia = sf.Inertia(1.0, (length / 2, 0, 0), (0.1, 0.1, 0.1))
        frames = (sf.Frame("end", (length, 0, 0)),)
        bodies.append(sf.RigidBody(f"b{i}", sf.Joint(f"q{i}", "revolute", **place), inertia, frames))
    shut = sf.Closure("shut", (bodies[-1].name, "end"), (bodies[-2].name, "end"), ("x", "y"))
    return sf.System("drawn", tuple(bodies), constraints=(shut,))


@pytest.mark.parametrize("lengths", [(1.0, 1.0, 1.0), (0.4, 1.0, 0.7), (0.2, 0.3), (1.0,) * 5, (5e-3, 8e-3, 4e-3)])
@pytest.mark.parametrize("share", [0.8, 0.5, 0.3])
def test_a_loop_that_was_just_drawn_closes(lengths: tuple[float, ...], share: float) -> None:
    """Links in one line hold no direction that closes the loop; the answer is the same each time."""
    ground = share * sum(lengths)
    m = sf.compile(loop_in_line(lengths, ground), sf.Options(FUNCTIONS.functions, backend="interpreter"))
    found, again = sf.assemble(m), sf.assemble(m)
    assert np.abs(m.constraint(found.q)).max() <= 1e-12 and found.iterations > 0
    assert np.array_equal(found.q, again.q)
    first = found.q[0] + 0.01 if len(lengths) > 2 else found.q[0]
    held = sf.assemble(m, [first, *m.neutral()[1:]], held=["q0"])
    assert held.q[0] == first and np.abs(m.constraint(held.q)).max() <= 1e-12


def test_a_loop_that_is_too_short_is_refused_from_a_line_too() -> None:
    m = sf.compile(loop_in_line((0.4, 0.4), 1.0), sf.Options(FUNCTIONS.functions, backend="interpreter"))
    with pytest.raises(sf.AssemblyError, match=r"at 'shut\.x'; 8 guesses near it do not close it either\n"):
        sf.assemble(m)


def test_guesses_that_were_not_tried_are_not_said() -> None:
    """All that moves is held, so there is nothing to shift."""
    m = sf.compile(loop_in_line((0.4, 0.4), 1.0), sf.Options(FUNCTIONS.functions, backend="interpreter"))
    with pytest.raises(sf.AssemblyError) as refused:
        sf.assemble(m, held=m.names.v)
    assert "guesses" not in str(refused.value)


def test_out_of_reach_names_the_condition() -> None:
    m = sf.compile(MODELS["slider_crank"], FUNCTIONS).with_parameters(L2=0.05)
    with pytest.raises(sf.AssemblyError, match=r"phi = .* at 'gudgeon\.y'; held: turn"):
        sf.assemble(m, [1.5, -1.5, 0.0], held=["turn"])


def test_speeds_that_can_not_be() -> None:
    m = sf.compile(MODELS["four_bar"], FUNCTIONS)
    with pytest.raises(sf.AssemblyError, match="no speeds keep it closed"):
        sf.assemble(m, [1.2, -1.2, 1.2], [1.0, 0.0, 0.0], held=["q1", "q3"])


def test_contradicting_closures() -> None:
    system = MODELS["four_bar"]
    other = sf.Rod("too_long", ("crank", "end"), ("rocker", "end"), 1.5)
    m = sf.compile(replace(system, constraints=(*system.constraints, other)), FUNCTIONS)
    with pytest.raises(sf.AssemblyError, match="can't be assembled"):
        sf.assemble(m, [1.2, -1.0, 1.3])


def test_the_wrong_way_round() -> None:
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)))
    shut = sf.Closure("latch", ("world", None), ("b", None), (), ("z", "x", "y"))
    m = sf.compile(sf.System("s", (body,), constraints=(shut,)), FUNCTIONS)
    assert sf.assemble(m, [0.4]).q[0] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(sf.AssemblyError, match="'latch' is closed the wrong way round"):
        sf.assemble(m, [np.pi - 0.1])


def test_unknown_names() -> None:
    with pytest.raises(sf.UnknownNameError, match="did you mean 'q1'"):
        sf.assemble(sf.compile(MODELS["four_bar"], FUNCTIONS), held=["q11"])


def test_a_guess_where_constraints_are_not_smooth() -> None:
    """A disc that lies flat touches the ground all around: no direction leads to its contact."""
    with pytest.raises(sf.AssemblyError, match=r"has no finite derivative there\n(.*\n)*.*another guess"):
        sf.assemble(sf.compile(MODELS["rolling_disc"], FUNCTIONS))


def test_a_guess_with_a_quaternion_that_is_no_rotation_is_refused() -> None:
    model = compiled("rolling_disc")
    guess = model.neutral()
    ball = next(s for s in model.record.segments if s.kind != "linear")
    first = ball.q + ball.translations
    guess[first : first + 4] *= 1.5
    with pytest.raises(sf.ShapeError, match="holds a quaternion that is no rotation"):
        sf.assemble(model, guess)
