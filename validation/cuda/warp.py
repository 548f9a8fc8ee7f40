"""MuJoCo Warp: M and the bias, forward dynamics, and steps of semi-implicit Euler, without contacts."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

import numpy as np

from ..adapters.mujoco import tree
from ..contract import interface as contract
from ..mechanics.geometry import Array
from ..timing.race import error
from .record import PEER, PeerRow
from .states import STEP, STEPS, Subject

# States in a call: the fastest of these counts.
WORLDS = (8192, 32768, 131072)
# Repetitions of as many calls as there are steps, of which the fastest counts.
_REPEATS = 5
FUNCTIONS = ("dynamics", "forward_dynamics", "step")
# Its constraints are off: without room for any the solver is left out.
_ROOM = 0


def missing() -> str:
    """Why it does not import; "" where it does."""
    try:
        import_module("mujoco_warp")
    except ImportError as problem:
        return f"{PEER}: {problem}; `pip install mujoco-warp`"
    return ""


def rows(subject: Subject, worlds: tuple[int, ...] = WORLDS) -> Iterator[PeerRow]:
    """MuJoCo Warp's error and highest rate over numbers of worlds, for each function of a model.

    Raises:
        ValueError: MuJoCo can't hold the model.
    """
    engine = tree.build(contract.Subject(subject.label, subject.system))
    if isinstance(engine, contract.Unsupported):
        raise ValueError(f"{PEER}: {engine.reason}")
    side = _Side(engine, subject)
    for function in FUNCTIONS:
        off = side.error(function)
        rate, number = max((side.rate(function, number), number) for number in worlds)
        yield PeerRow(subject.label, function, number, rate, off)


class _Side:
    """A model in its hands, in single precision.

    Args:
        engine: MuJoCo's model, and the map between its coordinates and ours.
        subject: Our model, and states.
    """

    def __init__(self, engine: Any, subject: Subject) -> None:
        self._warp, self._peer, mujoco = map(import_module, ("warp", "mujoco_warp", "mujoco"))
        # Else it prints what it compiles among the results; newer releases go by the level, older ones by `quiet`.
        self._warp.config.quiet, self._warp.config.log_level = True, logging.WARNING
        self._subject, self._chart, self._described = subject, engine.chart, engine.model
        self._described.opt.timestep = STEP
        self._described.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        bits = mujoco.mjtDisableBit
        self._described.opt.disableflags |= bits.mjDSBL_CONTACT | bits.mjDSBL_CONSTRAINT | bits.mjDSBL_EULERDAMP
        self._model = self._peer.put_model(self._described)
        forces = np.zeros_like(subject.v)
        forces[:, subject.model.nv - subject.model.nu :] = subject.u
        chart = self._chart
        self._start = (
            chart.coordinates(subject.q),
            chart.speeds(subject.q, subject.v),
            chart.forces(subject.q, forces),
        )

    def _data(self, number: int) -> Any:
        """Data of so many worlds, in the states of the subject, which are repeated."""
        data = self._peer.make_data(self._described, nworld=number, nconmax=_ROOM, njmax=_ROOM)
        self._reset(data, number)
        return data

    def _reset(self, data: Any, number: int) -> None:
        times = -(-number // len(self._subject.q))
        for target, values in zip((data.qpos, data.qvel, data.qfrc_applied), self._start, strict=True):
            filled = np.tile(values, (times, 1))[:number].astype(np.float32)
            self._warp.copy(target, self._warp.array(filled, dtype=self._warp.float32))

    def _call(self, function: str, data: Any) -> Callable[[], None]:
        peer, model = self._peer, self._model
        calls = {
            "dynamics": [peer.kinematics, peer.com_pos, peer.crb, peer.com_vel, peer.rne],
            "forward_dynamics": [peer.forward],
            "step": [peer.step],
        }[function]

        def call() -> None:
            for one in calls:
                one(model, data)

        return call

    def rate(self, function: str, number: int) -> float:
        """States a second, the calls captured in a graph where there is a graphics processor."""
        data, warp = self._data(number), self._warp
        call = launch = self._call(function, data)
        call()
        if warp.get_device().is_cuda:
            with warp.ScopedCapture() as captured:
                call()

            def launch() -> None:
                warp.capture_launch(captured.graph)

        best = np.inf
        for _ in range(_REPEATS):
            self._reset(data, number)
            warp.synchronize()
            begun = time.perf_counter()
            for _ in range(STEPS):
                launch()
            warp.synchronize()
            best = min(best, (time.perf_counter() - begun) / STEPS)
        return number / float(best)

    def error(self, function: str) -> float:
        """The largest difference from C: of the bias, of accelerations, of configurations after all steps."""
        subject, chart = self._subject, self._chart
        data = self._data(len(subject.q))
        call = self._call(function, data)
        for _ in range(STEPS if function == "step" else 1):
            call()
        if function == "step":
            return error(data.qpos.numpy().astype(float), chart.coordinates(subject.moved["semi_implicit_euler"]))
        if function == "forward_dynamics":
            found: Array = chart.our_accelerations(subject.q, subject.v, data.qacc.numpy().astype(float))
            return error(found, subject.expected(function))
        to_ours = np.linalg.inv(chart.transform(subject.q))
        mass = to_ours.transpose(0, 2, 1) @ subject.model.mass_matrix(subject.q) @ to_ours
        bias = chart.bias(subject.q, subject.v, data.qfrc_bias.numpy().astype(float), mass)
        return error(bias, subject.model.bias(subject.q, subject.v))
