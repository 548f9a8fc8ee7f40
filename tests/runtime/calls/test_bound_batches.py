"""Batches bound to their memory: the bits of the plain call and the values of NumPy's interpreter, in any layout."""

from __future__ import annotations

import gc
import tracemalloc

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.bound import Layout
from symofros.runtime.calls.library import MANY
from symofros.runtime.calls.sharing import LEAST
from tests.models import GUESSES, model, sampled

CLOSED = "four_bar"


def states(m: sf.Model, n: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(n)), strict=True))
    return {"q": q, "v": v, "a": rng.normal(size=(n, m.nv)), "u": rng.normal(size=(n, m.nu))}


def written(bound: sf.runtime.bound.Bound, given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    for group in bound.inputs.keys() & given.keys():
        bound.inputs[group][...] = given[group]
    return given


def check(bound: sf.runtime.bound.Bound, plain: object, reference: object) -> None:
    """The bits of the plain call; by NumPy's interpreter the same within rounding; and no output is all zeros."""
    results = [value if isinstance(value, tuple) else (value,) for value in (plain, reference)]
    for output, same, expected in zip(bound.outputs.values(), *results, strict=False):
        assert output.shape == same.shape and np.array_equal(output, same)
        assert np.any(expected) and output == pytest.approx(expected, rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("layout", ["rows", "columns"])
@pytest.mark.parametrize("n", [1, 7, MANY - 1, MANY, MANY + 3])
@pytest.mark.parametrize("name", ["dynamics", "forward_dynamics", "kinetic_energy"])
@pytest.mark.parametrize("batch", ["vector", "loop"])
def test_the_bits_of_the_plain_call(name: str, n: int, layout: Layout, batch: str, rng: np.random.Generator) -> None:
    m = sf.compile(MODELS["double_pendulum"], sf.Options(batch=batch))
    bound = m.bind(name, n=n, layout=layout)
    gc.collect(1)  # What C has the addresses of must be held by the Bound.
    for _ in range(2):
        given = written(bound, states(m, n, rng))
        bound()
        plain, reference = (
            getattr(a_model, name)(*(given[group] for group in bound.inputs if group in given))
            for a_model in (m, model("double_pendulum"))
        )
        check(bound, plain, reference)


@pytest.mark.parametrize("layout", ["rows", "columns"])
@pytest.mark.parametrize("threads", [1, 3])
def test_threads_do_not_change_a_bit(layout: Layout, threads: int, rng: np.random.Generator) -> None:
    n = 3 * LEAST + 5
    m = sf.compile(MODELS["double_pendulum"]).with_threads(threads)
    bound = m.bind("dynamics", n=n, layout=layout)
    given = written(bound, states(m, n, rng))
    bound()
    state = given["q"], given["v"], given["u"]
    check(bound, m.dynamics(*state), model("double_pendulum").dynamics(*state))


@pytest.mark.parametrize("n", sampled([5, MANY], [5]))
def test_functions_that_a_solver_finishes(n: int, rng: np.random.Generator) -> None:
    m = sf.compile(MODELS[CLOSED])
    bound = m.bind("project", n=n, layout="columns")
    given = states(m, n, rng)
    given["q"] = np.array(GUESSES[CLOSED]) + 0.01 * given["q"]
    written(bound, given)
    bound()
    q, v, left = m.project(given["q"], given["v"], u=given["u"])
    check(bound, (q, v), model(CLOSED).project(given["q"], given["v"], u=given["u"])[:2])
    # The posture is another one, and the loop is closed there: two legs of one length between equal pivots.
    assert np.all(left < 1e-9) and np.all(np.abs(q - given["q"]).max(axis=1) > 1e-8)
    assert q[:, 0] + q[:, 1] == pytest.approx(np.zeros(n), abs=1e-9)


@pytest.mark.parametrize("n", [6, MANY + 1])
def test_memory_of_the_caller_as_it_lies(n: int, rng: np.random.Generator) -> None:
    """A column of a wider array, every second state in reverse, states side by side: read and written in place."""
    m = model("parametrised0", "c")
    nv = m.nv
    given = states(m, n, rng)
    q = np.zeros((n, m.nq + 3))[:, 2 : 2 + m.nq]
    v = np.zeros((2 * n, nv))[::-2]
    M = np.moveaxis(np.zeros((nv, nv, n)), -1, 0)
    bound = m.bind("dynamics", n=n, q=q, v=v, M=M)
    assert bound.inputs["q"] is q and bound.inputs["v"] is v and bound.outputs["M"] is M
    written(bound, given)
    bound()
    state = given["q"], given["v"], given["u"]
    check(bound, m.dynamics(*state), model("parametrised0").dynamics(*state))


def test_frames_and_times(rng: np.random.Generator) -> None:
    m = model("parametrised0", "c")
    given = states(m, 9, rng)
    pose = m.bind("frame_pose", m.names.frames[-1], n=9)
    written(pose, given)
    pose()
    last = m.names.frames[-1]
    check(pose, m.frame_pose(last, given["q"]), model("parametrised0").frame_pose(last, given["q"]))
    driven = sf.compile(
        sf.System("s", [sf.RigidBody("b", sf.Joint("j", "revolute", effort=("sin(t)",)), sf.Inertia(1.0))])
    )
    Q = driven.bind("generalized_force", n=9)
    Q.inputs["t"][:, 0] = t = rng.normal(size=9)
    Q()
    expected = driven.generalized_force(np.zeros((9, 1)), np.zeros((9, 1)), np.zeros((9, driven.nu)), t=t)
    assert np.array_equal(Q.outputs["Q"], expected)
    assert expected[:, 0] == pytest.approx(np.sin(t), rel=1e-14)


@pytest.mark.parametrize("layout", ["rows", "columns"])
def test_a_call_keeps_no_memory(layout: Layout) -> None:
    bound = sf.compile(MODELS["double_pendulum"]).bind("dynamics", n=4096, layout=layout)
    bound()
    tracemalloc.start()
    for _ in range(3):
        bound()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8192  # M alone is of 131072 bytes.


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((4, 3)),
        np.zeros((3, 2)),
        np.zeros(3),
        np.zeros((4, 2), dtype=np.float32),
        [[0.0, 0.0]] * 4,
        np.broadcast_to(np.zeros(2), (4, 2)),
        np.zeros((4, 2), dtype=">f8"),
        np.ndarray((4, 2), buffer=bytearray(100), strides=(20, 8)),
    ],
)
def test_other_arrays_are_refused(array: np.ndarray) -> None:
    with pytest.raises(sf.ShapeError, match=r"'q' can't be bound(.|\n)*shape \(4, 2\), or \(2,\) for all states"):
        model("double_pendulum", "c").bind("mass_matrix", n=4, q=array)
