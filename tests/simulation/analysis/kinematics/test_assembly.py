"""Assembly: loops close near the guess, what is held stays, what can't close is said."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.closed.spatial import delta_guess, stewart_guess
from tests.simulation.mechanisms import loop

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
def test_assembled_loops_close_with_the_least_change_of_speeds(name: str) -> None:
    m = sf.compile(MODELS[name], FUNCTIONS)
    wished = np.random.default_rng(0).normal(size=m.nv)
    found = sf.assemble(m, GUESSES[name], wished)
    assert np.abs(m.constraint(found.q)).max() <= 1e-12 and np.abs(m.constraint_rate(found.q, found.v)).max() < 1e-10
    # Speeds change by the least that is needed: the change has no part along motions that the constraints allow.
    G = m.constraint_jacobian(found.q)
    change = found.v - wished
    assert np.linalg.norm(change - np.linalg.pinv(G, rcond=1e-8) @ (G @ change)) < 1e-9 * np.linalg.norm(wished)


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e4, 1e8])
def test_loops_of_all_sizes_close(size: float) -> None:
    m = sf.compile(MODELS["slider_crank"], FUNCTIONS)
    m = m.with_parameters(L1=0.15 * size, L2=0.3 * size)
    for turn in (0.5, 1.3, 2.0, -2.8):
        closed = sf.assemble(m, [turn, -0.5 * turn, 0.3 * size], [1.0, 0.0, 0.0], held=["turn"])
        assert np.abs(m.constraint(closed.q)).max() <= max(1e-12 * min(1e3 * size, 1.0), 1e-14 * size)
        assert np.abs(m.constraint_rate(closed.q, closed.v)).max() <= 1e-12 * size


def loop_in_line(lengths: tuple[float, ...], ground: float) -> sf.Model:
    """A planar loop as it is drawn, its links in one line."""
    system = loop(lengths, ground, (0, 0, 1), rows=(("x", "y"), ()))
    return sf.compile(system, sf.Options(FUNCTIONS.functions, backend="interpreter"))


@pytest.mark.parametrize("lengths", [(1.0, 1.0, 1.0), (0.2, 0.3), (1.0,) * 5, (5e-3, 8e-3, 4e-3)])
@pytest.mark.parametrize("share", [0.8, 0.3])
def test_a_loop_that_was_just_drawn_closes(lengths: tuple[float, ...], share: float) -> None:
    """Links in one line hold no direction that closes the loop; the answer is the same each time."""
    ground = share * sum(lengths)
    m = loop_in_line(lengths, ground)
    found, again = sf.assemble(m), sf.assemble(m)
    assert np.abs(m.constraint(found.q)).max() <= 1e-12 and found.iterations > 0
    assert np.array_equal(found.q, again.q)
    first = found.q[0] + 0.01 if len(lengths) > 2 else found.q[0]
    held = sf.assemble(m, [first, *m.neutral()[1:]], held=["q1"])
    assert held.q[0] == first and np.abs(m.constraint(held.q)).max() <= 1e-12


def test_a_loop_that_is_too_short_is_refused_from_a_line_too() -> None:
    m = loop_in_line((0.4, 0.4), 1.0)
    with pytest.raises(sf.AssemblyError, match=r"at 'shut\.x'; 8 guesses near it do not close it either\n"):
        sf.assemble(m)


def test_unreachable_postures_name_the_condition() -> None:
    m = sf.compile(MODELS["slider_crank"], FUNCTIONS).with_parameters(L2=0.05)
    with pytest.raises(sf.AssemblyError, match=r"phi = .* at 'gudgeon\.y'; held: turn"):
        sf.assemble(m, [1.5, -1.5, 0.0], held=["turn"])


def test_impossible_speeds_are_refused() -> None:
    m = sf.compile(MODELS["four_bar"], FUNCTIONS)
    with pytest.raises(sf.AssemblyError, match="no speeds keep it closed"):
        sf.assemble(m, [1.2, -1.2, 1.2], [1.0, 0.0, 0.0], held=["q1", "q3"])


def test_closures_facing_the_wrong_way_are_refused() -> None:
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)))
    shut = sf.Closure("latch", ("world", None), ("b", None), (), ("z", "x", "y"))
    m = sf.compile(sf.System("s", (body,), constraints=(shut,)), FUNCTIONS)
    assert sf.assemble(m, [0.4]).q[0] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(sf.AssemblyError, match="'latch' is closed the wrong way round"):
        sf.assemble(m, [np.pi - 0.1])


def test_a_guess_with_nonsmooth_constraints_is_refused() -> None:
    """A disc that lies flat touches the ground all around: no direction leads to its contact."""
    with pytest.raises(sf.AssemblyError, match=r"has no finite derivative there\n(.*\n)*.*another guess"):
        sf.assemble(sf.compile(MODELS["rolling_disc"], FUNCTIONS))
