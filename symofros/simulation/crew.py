"""Crews of native/crew.c: each a thread's, with its share of the trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event

import numpy as np
import numpy.typing as npt

from symofros.runtime.kernel import Array, Lanes
from symofros.runtime.model import Model
from symofros.simulation.batch_inputs import BatchInputs
from symofros.simulation.settings import Settings
from symofros.simulation.stepper import Stepper

# Trajectories in hand at once: eight vectors of eight; few enough for the first two caches.
_SLOTS = 64
# Steps of each between looks at Ctrl-C.
_ROUNDS = 64


@dataclass(frozen=True)
class Starts:
    """Where trajectories begin, a row each, or one for all.

    Attributes:
        q: (n or 1, nq).
        v: (n or 1, nv).
        par: (n or 1, npar).
        inputs: Of all.
        n: How many.
        t: When [s].
    """

    q: Array
    v: Array
    par: Array
    inputs: BatchInputs
    n: int
    t: float


@dataclass(frozen=True)
class Ends:
    """What crews write: how each trajectory ended and where, and its samples."""

    status: npt.NDArray[np.int32]
    t: Array
    q: Array
    v: Array
    steps: npt.NDArray[np.int64]
    rejected: npt.NDArray[np.int64]
    q_samples: Array
    v_samples: Array
    u_samples: Array

    @classmethod
    def of(cls, model: Model, n: int, samples: int) -> Ends:
        """Room for n trajectories of so many samples, none of which is reached yet."""
        q, v, u = (np.full((n, samples, size), np.nan) for size in (model.nq, model.nv, model.nu))
        return cls(
            np.zeros(n, dtype=np.int32),
            np.zeros(n),
            np.zeros((n, model.nq)),
            np.zeros((n, model.nv)),
            np.zeros(n, dtype=np.int64),
            np.zeros(n, dtype=np.int64),
            q,
            v,
            u,
        )


class Crew:
    """Every `by`-th trajectory from the `first` on.

    Args:
        model: What moves.
        settings: Of every run.
        starts: Of all trajectories.
        ends: Where results go; a status below zero beforehand keeps a trajectory from beginning.
        t_end: Where to end [s].
        max_steps: Of each; none by default.
        first: Trajectory.
        by: See above.
    """

    def __init__(
        self,
        model: Model,
        settings: Settings,
        starts: Starts,
        ends: Ends,
        first: int,
        by: int,
    ) -> None:
        self.single = Stepper(model, settings.method, starts.inputs.plan, (), starts.par[0])
        settings.apply(self.single)
        self._native, self._ffi = self.single.native, self.single.ffi
        self._crew = self._ffi.new("sym_crew *")
        self._slots = min(_SLOTS, max(2, -(-starts.n // by)))
        self._lay_out(model, settings, starts)
        self._place(starts, ends)
        crew = self._crew
        crew.next, crew.by, crew.n, crew.max_steps = first, by, starts.n, settings.max_steps or 0
        self._native.sym_crew_start(crew)

    def _lay_out(self, model: Model, settings: Settings, starts: Starts) -> None:
        crew, single, slots = self._crew, self.single, self._slots
        crew.like, crew.slots = single.run, slots
        samples = int(single.run.n_grid)
        single.run.capacity = samples
        single.run.record_t = single.numbers(np.zeros(max(1, samples)))
        for name in ("scenes", "runs", "signals"):
            kind = f"sym_{name[:-1]}[]"
            setattr(crew, name, single.own(kind, slots * (max(1, single.scene.n_signals) if name == "signals" else 1)))
        crew.whose, crew.status = single.own("int64_t[]", slots), single.own("int32_t[]", slots)
        n, stages = 2 * model.nv, max(1, len(settings.method.tableau.b))
        widths = {
            "q": model.nq,
            "v": model.nv,
            "u": model.nu,
            "t": 1,
            "states": model.nq + model.nv,
            "step": 1,
            "end": 1,
            "y1": n,
            "stage": n,
            "size": n,
            "dense": n,
            "base": n,
            "length": n,
            "k": stages * n,
        }
        for name, width in widths.items():
            setattr(crew, name, single.numbers(np.zeros(slots * width)))
        single.run.y = single.numbers(np.zeros(self._native.sym_work_size(single.run)))
        for name, sizes in (("forward", (model.nv, model.nc, 1)), ("law", (single.scene.n_law,)), ("project", ())):
            self._many(name, sizes, starts.par)

    def _many(self, name: str, sizes: Sequence[int], par: Array) -> None:
        """A function that all in hand call; `project` is called one by one."""
        kernel = self.single.kernels.get(name)
        if kernel is None:
            return
        many, single = getattr(self._crew, name), self.single
        pre = kernel.prepare(par)
        many.pre.at, many.pre.stride = single.shared(pre), pre.shape[1] if len(pre) > 1 else 0
        if not sizes:
            return
        # Laws are few operations on what users gave: in double precision.
        precision = single.model.precision if name == "forward" else "double"
        vectors = kernel.in_lanes(Lanes(many.pre.stride != 0, precision))
        many.function = self._ffi.cast("sym_function *", vectors.address)
        many.work = single.numbers(np.zeros(max(1, vectors.work)))
        many.pre_here = single.numbers(np.zeros(self._slots * pre.shape[1]))
        for i, size in enumerate(sizes):
            many.out[i] = single.numbers(np.zeros(self._slots * size))
        single.keep(vectors)

    def _place(self, starts: Starts, ends: Ends) -> None:
        crew, single = self._crew, self.single
        for name, rows in (("q0", starts.q), ("v0", starts.v), ("constant", starts.inputs.constant)):
            into = getattr(crew, name)
            into.at, into.stride = single.shared(rows), rows.shape[1] if len(rows) > 1 else 0
        crew.signal_stride = single.own("int64_t[]", list(starts.inputs.strides) or 1)
        for name, array in (
            ("last_t", ends.t),
            ("last_q", ends.q),
            ("last_v", ends.v),
            ("record_q", ends.q_samples),
            ("record_v", ends.v_samples),
            ("record_u", ends.u_samples),
        ):
            setattr(crew, name, single.shared(array))
        for name, kind, whole in (
            ("ended", "int32_t *", ends.status),
            ("steps", "int64_t *", ends.steps),
            ("rejected", "int64_t *", ends.rejected),
        ):
            single.keep(whole)
            setattr(crew, name, self._ffi.cast(kind, self._ffi.from_buffer(whole)))

    def run(self, stop: Event) -> None:
        """To the end of every trajectory, or until told to stop; other threads run meanwhile."""
        try:
            while self._native.sym_crew_advance(self._crew, _ROUNDS):
                if stop.is_set():
                    break
        finally:  # Ctrl-C in the main thread comes between two calls: what is in hand is put down.
            self._native.sym_crew_stop(self._crew)


def run_crews(crews: Sequence[Crew]) -> None:
    """Each in a thread of its own; Ctrl-C ends all, and what they have is kept."""
    stop = Event()
    try:
        if len(crews) == 1:
            crews[0].run(stop)
            return
        with ThreadPoolExecutor(len(crews)) as pool:
            running = [pool.submit(crew.run, stop) for crew in crews]
            try:
                for future in running:
                    future.result()
            finally:
                stop.set()
    except KeyboardInterrupt:
        pass
