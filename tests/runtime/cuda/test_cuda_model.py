"""Models on a graphics processor, with a driver whose processor is the host: arrays in place, rollouts, words."""

from __future__ import annotations

import copy
import ctypes
import pickle
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.errors import ShapeError, SymofrosError, UnknownNameError
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver, driver
from tests.interop.turning import SYSTEMS
from tests.models import model
from tests.runtime.cuda.foreign_arrays import STATES, Exchanged, OnDevice, WithGradient, WithGradientExchanged, states
from tests.runtime.test_unit_quaternions import with_length


@pytest.mark.parametrize("n", [1, 2, 128, 300])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("place", [np.asarray, OnDevice, Exchanged])
def test_batches_of_any_layout_give_the_bits_of_the_model(on_device: CudaModel, n: int, order: Any, place: Any) -> None:
    q, v = (np.array(x, order=order) for x in states(n))
    results = on_device.evaluate("dynamics", q=place(q), v=place(v), u=[0.5, -1.0])
    wanted = model("double_pendulum").dynamics(q, v, np.array([0.5, -1.0]))
    for result, expected in zip(results.values(), wanted, strict=True):
        assert np.array_equal(result.numpy(), expected)


def test_states_of_results_lie_side_by_side(on_device: CudaModel) -> None:
    q, v = states(5)
    M = on_device.evaluate("dynamics", q=q, v=v)["M"]
    assert M.shape == (5, 2, 2) and M.strides == (8, 80, 40)
    assert M.__cuda_array_interface__["shape"] == (5, 2, 2)
    again = on_device.evaluate("forward_dynamics", q=q, v=v, u=on_device.evaluate("dynamics", q=q, v=v)["h"])
    assert np.allclose(again["a"].numpy(), 0.0, atol=1e-12)  # Efforts that balance; in place from one to the next.


def test_results_are_written_into_arrays_that_are_given(on_device: CudaModel) -> None:
    q, v = states(7)
    M = np.full((7, 2, 2), np.nan)
    results = on_device.evaluate("dynamics", q=q, v=v, out={"M": OnDevice(M)})
    assert results["M"].array is M
    assert np.array_equal(M, model("double_pendulum").mass_matrix(q))
    with pytest.raises(ShapeError, match="entries at equal distances"):
        on_device.evaluate("dynamics", q=q, v=v, out={"M": OnDevice(np.zeros((7, 2, 4))[:, :, :2])})


MEMORY = np.zeros((3, 16))
READ_ONLY = OnDevice(np.zeros((3, 2, 2)))
READ_ONLY.__cuda_array_interface__ |= {"data": (READ_ONLY.array.ctypes.data, True)}


@pytest.mark.parametrize(
    ("out", "words"),
    [
        ({"M": np.zeros((3, 2, 2))}, "M does not lie on the device"),
        ({"mass": OnDevice(np.zeros((3, 2, 2)))}, "no output 'mass'"),
        (OnDevice(np.zeros((3, 2, 2))), "out is no mapping"),
        ({"M": READ_ONLY}, "M is read only"),
        ({"M": OnDevice(np.broadcast_to(np.zeros((2, 2)), (3, 2, 2)))}, "M shares memory(.|\n)*with itself"),
        ({"h": OnDevice(MEMORY[:, 1:3])}, "h shares memory(.|\n)*with q"),
        (
            {"h": OnDevice(MEMORY[:, 10:12]), "M": OnDevice(MEMORY[:, 8:12].reshape(3, 2, 2))},
            "h shares memory(.|\n)*with M",
        ),
    ],
)
def test_arrays_that_cannot_receive_results_are_refused(on_device: CudaModel, out: dict[str, Any], words: str) -> None:
    """Results would be written into a copy, over what is read, or nowhere."""
    with pytest.raises((ShapeError, UnknownNameError), match=words):
        on_device.evaluate("dynamics", q=OnDevice(MEMORY[:, :2]), v=OnDevice(MEMORY[:, 2:4]), out=out)


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler"])
@pytest.mark.parametrize("given", ["all", "states", "steps"])
def test_rollouts_hold_the_inputs_of_each_step(on_device: CudaModel, method: str, given: str) -> None:
    q, v = states(6)
    u = np.random.default_rng(4).standard_normal({"all": (2,), "states": (6, 2), "steps": (6, 6, 2)}[given])
    records = on_device.rollout(q, v, u, dt=0.01, steps=6, every=3, method=method)
    assert records[0].shape == (2, 6, 2)
    held = np.broadcast_to(u, (6, 6, 2))
    at_q, at_v = q, v
    for step in range(6):
        runs = [
            sf.simulate(model("double_pendulum", "c"), a, b, 0.01, u=w, method=method, dt=0.01)
            for a, b, w in zip(at_q, at_v, held[step], strict=True)
        ]
        at_q, at_v = np.array([run.q[-1] for run in runs]), np.array([run.v[-1] for run in runs])
        if step % 3 == 2:
            for record, wanted in zip(records, (at_q, at_v), strict=True):
                assert np.abs(record.numpy()[step // 3] - wanted).max() < 1e-12


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"q": np.zeros((3, 2))}, "no v"),
        (STATES | {"q": np.zeros((3, 3))}, "q has the wrong shape"),
        (STATES | {"v": np.zeros((4, 2))}, "one number of states"),
        (STATES | {"w": 1.0}, "no input 'w'"),
        (STATES | {"q": OnDevice(np.zeros((3, 2), "f4"))}, "float64"),
        ({"q": Exchanged(np.zeros((3, 2)), 1), "v": np.zeros(2)}, "device 1 of DLPack"),
        ({"q": Exchanged(np.zeros((3, 2)), 2, 1), "v": np.zeros(2)}, "graphics processor 1;"),
        ({"q": Exchanged(np.zeros((3, 2), "i8")), "v": np.zeros(2)}, "int64"),
        (STATES | {"t": np.zeros(4)}, "one number of"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(on_device: CudaModel, inputs: dict[str, Any], message: str) -> None:
    with pytest.raises((ShapeError, UnknownNameError), match=message):
        on_device.evaluate("dynamics", **inputs)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"every": 3}, "no such rollout"),
        ({"steps": 10, "every": 3}, "every divides steps"),
        ({"dt": 0.0}, "a step is positive"),
        ({"dt": -0.1}, "a step is positive"),
        ({"dt": np.nan}, "a step is positive"),
        ({"steps": 2.5}, "steps is no whole number"),
        ({"every": True}, "every is no whole number"),
        ({"method": "rk5"}, "by 'rk5'"),
        ({"u": np.zeros((3, 3, 2))}, "u has the"),
        ({"u": np.zeros((4, 2))}, "one number of"),
    ],
)
def test_rollouts_that_do_not_fit_are_refused(on_device: CudaModel, options: dict[str, Any], message: str) -> None:
    with pytest.raises((ShapeError, UnknownNameError), match=message):
        on_device.rollout(**{**STATES, "dt": 0.1, "steps": 2, **options})


@pytest.mark.parametrize("length", [1.1, 0.0])
def test_rollouts_refuse_invalid_quaternions_like_simulate(length: float) -> None:
    body = model("torque_free_body")
    q = np.tile(body.neutral(), (3, 1))
    q[1, -1] = length
    for start in (
        lambda: body.cuda().rollout(q, np.zeros((3, body.nv)), dt=0.1, steps=1),
        lambda: sf.simulate_batch(body, q, t_end=0.1, dt=0.1),
    ):
        with pytest.raises(ShapeError, match=rf"a quaternion that is no rotation(.|\n)*length {length:g}"):
            start()


def test_quaternions_of_the_host_are_taken_as_by_the_model(on_device: CudaModel) -> None:
    swing = sf.compile(SYSTEMS["swing"]())
    gpu = swing.cuda()
    q, v = (np.array(x) for x in zip(*(swing.random_state(np.random.default_rng(k)) for k in range(3)), strict=True))
    expected = swing.bias(q, v)
    for length in (1.0, 1.0 + 1e-6, 1.0 - 9e-4):
        h = gpu.evaluate("bias", q=with_length(swing, q, length), v=v)["h"].numpy()
        assert np.abs(h - expected).max() <= 1e-13 * np.abs(expected).max()
    for length in (1.1, 0.0):
        with pytest.raises(ShapeError, match=f"q holds a quaternion that is no rotation(.|\n)*length {length:g}"):
            gpu.evaluate("bias", q=with_length(swing, q, length), v=v)
    on_the_device = gpu.evaluate("bias", q=OnDevice(with_length(swing, q, 1.1)), v=v)["h"].numpy()
    assert np.abs(on_the_device - expected).max() > 0.1 * np.abs(expected).max()  # As it is.


def test_without_a_driver_the_error_names_it() -> None:
    try:
        ctypes.CDLL("libcuda.so.1")
    except OSError:
        with pytest.raises(SymofrosError, match="no graphics processor"):
            driver()
    else:
        pytest.skip("this machine has a driver")


def test_inputs_that_are_left_out_are_copied_once(on_device: CudaModel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy from the host would wait for every batch that was started before."""
    q, v = OnDevice(np.zeros((3, 2))), OnDevice(np.zeros((3, 2)))
    on_device.evaluate("forward_dynamics", q=q, v=v)
    copies = []
    monkeypatch.setattr(Driver, "write", lambda *arguments: copies.append(arguments))
    on_device.evaluate("forward_dynamics", q=q, v=v, wait=False)
    assert not copies


@pytest.mark.parametrize("tensor", [WithGradient, WithGradientExchanged])
@pytest.mark.parametrize("place", ["q", "out"])
def test_tensors_that_require_a_gradient_are_refused(on_device: CudaModel, tensor: Any, place: str) -> None:
    given = {"q": tensor()} if place == "q" else {"q": np.zeros((3, 2)), "out": {"M": tensor()}}
    with pytest.raises(ShapeError, match=r"is not given by its library(.|\n)*tensor.detach\(\)"):
        on_device.evaluate("mass_matrix", **given)


def test_a_model_on_the_device_is_copied_as_itself_and_not_pickled(on_device: CudaModel) -> None:
    assert copy.copy(on_device) is on_device and copy.deepcopy({"gpu": on_device})["gpu"] is on_device
    with pytest.raises(SymofrosError, match="can't be pickled"):
        pickle.dumps(on_device)
    result = on_device.evaluate("mass_matrix", q=np.zeros((3, 2)))["M"]
    for attempt in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(SymofrosError, match="not copied or pickled"):
            attempt(result)
