"""One model with all passes, then with each left out in turn: operations, code, time."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

import symofros as sf
from symofros.tools import ABLATIONS, count_program

from .. import references
from ..mechanics.geometry import Array
from ..reporting.command import Run, known
from ..reporting.record import Data
from ..timing.contestants.arrays import loops
from ..timing.contestants.library import Library
from ..timing.models import TIMED_MODELS
from ..timing.race import error, race
from ..timing.task import Loop

STATES = 256
ALL, AGAIN, APART = "all passes", "nothing (a copy)", "functions apart"
# Rounding differs by pass; results may not.
SAME = 1e-11
MODELS: dict[str, Callable[[], sf.System]] = {
    "panda7": TIMED_MODELS["panda"].load,
    "talos": TIMED_MODELS["talos"].load,
    "planar_robot": lambda: references.MODELS["planar_robot"],
    "flexible_mss": lambda: references.MODELS["flexible_mss"],
}
# M, h and Q in one function share their kinematics.
_FUSED, _PARTS = "dynamics", ("mass_matrix", "bias", "generalized_force")


@dataclass(frozen=True)
class Measured:
    """One model without one pass.

    Attributes:
        model: Label of the model.
        nv: Degrees of freedom.
        without: Name of the pass; ALL for none, AGAIN for none in a copy of the same library, which shows what the
            placement of code makes; APART for M, h and Q by three functions.
        operations: Executed by one call.
        text: Bytes of C.
        compilation: Time of compilation from C text to machine code, with generation [s].
        minimum: Time of one state [ns]; median: likewise.
        off: Largest relative difference of results from those with all passes.
    """

    model: str
    nv: int
    without: str
    operations: int
    text: int
    compilation: float
    minimum: float
    median: float
    off: float


def ablated(label: str, repeats: int, done: Callable[[str], None] = lambda doing: None) -> Iterator[Measured]:
    """All of one model, raced together.

    Raises:
        ArithmeticError: A pass changes what is computed.
    """
    system = MODELS[label]()
    built = {ALL: [_Variant(system, _FUSED)], AGAIN: [_Variant(system, _FUSED, copied=True)]}
    for item in ABLATIONS:
        built[item.name] = [_Variant(system, _FUSED, item.without, item.options)]
        done(f"{label} without {item.name}")
    built[APART] = [_Variant(system, name) for name in _PARTS]
    expected = built[ALL][0].results()
    off = {
        name: error(np.concatenate([one.results() for one in variants], axis=1), expected)
        for name, variants in built.items()
    }
    wrong = {name: value for name, value in off.items() if not value <= SAME}
    if wrong:
        raise ArithmeticError(
            f"{label}: results change without {', '.join(f'{n} ({x:.1e})' for n, x in wrong.items())}"
        )
    runs = {f"{name}/{i}": one.loop for name, variants in built.items() for i, one in enumerate(variants)}
    times = race(runs, STATES, repeats)
    for name, variants in built.items():
        mine = [times[f"{name}/{i}"] for i in range(len(variants))]
        yield Measured(
            label,
            variants[0].nv,
            name,
            sum(one.operations for one in variants),
            sum(one.text for one in variants),
            sum(one.seconds for one in variants),
            sum(t.minimum for t in mine),
            sum(t.median for t in mine),
            off[name],
        )


class _Variant:
    """One function of one model, compiled."""

    def __init__(
        self,
        system: sf.System,
        function: str,
        without: Callable[[], AbstractContextManager[object]] = nullcontext,
        options: Callable[[sf.Options], sf.Options] = lambda options: options,
        copied: bool = False,
    ) -> None:
        chosen = options(sf.Options((function,), batch="loop"))
        with without():
            program = sf.program_of(system, (function,))
            start = time.perf_counter()
            path, symbol = sf.compile_library(system, chosen)
        self.seconds = time.perf_counter() - start
        self.text = len(path.with_suffix(".c").read_text(encoding="utf-8"))
        self.operations = count_program(program)[function, ""].total
        if not copied:
            self._open(path, symbol)
            return
        with tempfile.TemporaryDirectory() as private:
            self._open(Path(shutil.copy(path, private)), symbol)

    def _open(self, path: Path, symbol: str) -> None:
        self._library, native = Library(path, symbol), loops()[1]
        model = self._library.model
        self.nv, self._function = int(model.nv), model.functions + 0
        self._arrays = self._library.arrays({"pre": self._library.pre, **_states(model.nq, model.nv, model.nu)})
        run = partial(native.loop_eval, self._function, self._arrays.overwritten())
        self.loop = Loop(_FUSED, "", run, self.results)

    def results(self) -> Array:
        """All outputs (STATES, size)."""
        native = loops()[1]
        return self._arrays.results(lambda kept: native.loop_eval(self._function, kept, 1))


def _states(nq: int, nv: int, nu: int) -> Mapping[str, Array]:
    """Deflections stay small; angles need not be large to cost what they cost."""
    rng = np.random.default_rng(11)
    return {name: rng.uniform(-0.5, 0.5, (STATES, size)) for name, size in (("q", nq), ("v", nv), ("u", nu))}


def measure(
    run: Run,
    models: Annotated[list[str] | None, typer.Option("--model", help=f"Only this one: {', '.join(MODELS)}.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = 101,
) -> Data:
    """Measure what each pass of the generator gains: the same models with one of them left out."""
    chosen = known(models, MODELS, "--model", "model")
    run.expect(len(chosen) * len(ABLATIONS))
    return {"rows": [asdict(row) for label in chosen for row in ablated(label, repeats, run.advance)]}
