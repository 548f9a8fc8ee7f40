"""Scene: what a model is to be used for, and how exact it has to be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Literal, get_args

import numpy as np

from symofros.base.arguments import CheckedCalls, check_fields, entries_of, shown
from symofros.base.arrays import Array
from symofros.errors import DescriptionError, Problem, did_you_mean
from symofros.simulation.results.trajectory import Trajectory

Kind = Literal["position", "coordinate", "speed", "effort"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True)
class Output(metaclass=CheckedCalls):
    """Something of interest, and how far it may be off.

    Attributes:
        name: Name, unique in the scene.
        kind: "position" of a frame's origin in the world [m], "coordinate", "speed", or "effort": an input's value,
            where a law gives it.
        of: Name of the frame, coordinate, speed (that of its coordinate) or input.
        absolute: Error allowed at any time, in its own unit.
        relative: The same as a share of its largest distance from its first value; the two are added.
    """

    name: str
    kind: Kind
    of: str
    absolute: float = 0.0
    relative: float = 0.0

    def __post_init__(self) -> None:
        """Check the kind and the tolerance."""
        what = f"output '{self.name}'"
        if not isinstance(self.kind, str) or self.kind not in KINDS:
            raise DescriptionError(
                f"{what}: unknown kind",
                shown(self.kind),
                f"one of {', '.join(KINDS)}",
                did_you_mean(str(self.kind), KINDS),
            )
        sizes = (self.absolute, self.relative)
        if not all(math.isfinite(size) and size >= 0.0 for size in sizes) or not any(sizes):
            raise DescriptionError(
                f"{what}: no tolerance",
                f"absolute {self.absolute!r}, relative {self.relative!r}",
                "both are finite and none is negative, and one of them is positive",
                "say what error does no harm, such as absolute: 1e-3",
            )

    def values(self, run: Trajectory) -> Array:
        """Values of the measured quantity over time (n, k).

        Raises:
            DescriptionError: The model has no such thing.
        """
        names = run.model.names
        try:
            if self.kind == "position":
                return run.frames[self.of][0]
            sources = {"coordinate": (names.q, run.q), "speed": (names.v, run.v), "effort": (names.u, run.u)}
            known, columns = sources[self.kind]
            return columns[:, [known.index(self.of)]]
        except (KeyError, ValueError):
            raise DescriptionError(missing(self, run.model.names)) from None

    def bound(self, values: Array) -> float:
        """The error that is allowed, for a motion (n, k) that is right."""
        travel = float(np.linalg.norm(values - values[0], axis=1).max())
        return self.absolute + self.relative * travel


def missing(output: Output, names: Any) -> Problem:
    """The problem of an output whose frame, coordinate, speed or input the model lacks."""
    known = {"position": names.frames, "coordinate": names.q, "speed": names.v, "effort": names.u}[output.kind]
    return Problem(
        f"output '{output.name}': there is no {'frame' if output.kind == 'position' else output.kind} '{output.of}'",
        ", ".join(known[:12]) or "none",
        "outputs are of frames, coordinates, speeds and inputs that the model has",
        did_you_mean(output.of, known),
    )


@dataclass(frozen=True)
class Scene(metaclass=CheckedCalls):
    """A task: how a system is driven, for how long, and what of its motion matters.

    Attributes:
        t_end: End time of the motion [s].
        outputs: Outputs that matter, each with its tolerance.
        inputs: Inputs as `sf.simulate` takes them: name -> number, formula or Signal.
        start: First coordinates by name, and speeds by "d" and the name of their coordinate; others are neutral.
        keep: Run-time parameters that have to remain so; any other may become a constant.
        fixed_step: Whether only methods of fixed steps will do, as in real time.
        samples: Number of instants at which motions are compared.
    """

    t_end: float
    outputs: tuple[Output, ...]
    inputs: Mapping[str, Any] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    keep: tuple[str, ...] = ()
    fixed_step: bool = False
    samples: int = 400

    def __post_init__(self) -> None:
        """Freeze the collections, check the numbers."""
        for name in ("outputs", "keep"):
            entries = entries_of(getattr(self, name))
            if entries is not None:
                object.__setattr__(self, name, tuple(entries))
        check_fields(self)
        for name in ("inputs", "start"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        if not (math.isfinite(self.t_end) and self.t_end > 0.0):
            raise DescriptionError("scene: no span of time", f"t_end {self.t_end!r}", "t_end > 0", "set it")
        names = [output.name for output in self.outputs]
        if not names or len(set(names)) < len(names):
            raise DescriptionError(
                "scene: outputs have no names of their own",
                ", ".join(names) or "no outputs",
                "a scene has outputs, each under another name",
                "say what matters in this scene",
            )
        if not 10 <= self.samples <= 100_000:
            raise DescriptionError(
                "scene: samples out of range", repr(self.samples), "10 to 100000", "400 suit most motions"
            )

    @property
    def frames(self) -> tuple[str, ...]:
        """Frames that outputs are of, each once."""
        return tuple(dict.fromkeys(output.of for output in self.outputs if output.kind == "position"))

    @property
    def times(self) -> Array:
        """When motions are compared (samples) [s]."""
        return np.linspace(0.0, self.t_end, self.samples)

    def within(self, tolerance: float | Mapping[str, float] | None) -> Scene:
        """The scene with other absolute tolerances, relative ones dropped: one for all outputs, or by name.

        Raises:
            DescriptionError: No such output, or no tolerance.
        """
        if tolerance is None:
            return self
        names = [output.name for output in self.outputs]
        given = dict(tolerance) if isinstance(tolerance, Mapping) else dict.fromkeys(names, tolerance)
        for name in given:
            if name not in names:
                raise DescriptionError(
                    f"tolerance: the scene has no output '{name}'",
                    ", ".join(names),
                    "tolerances are of outputs",
                    did_you_mean(name, names),
                )
        changed = (
            replace(one, absolute=float(given[one.name]), relative=0.0) if one.name in given else one
            for one in self.outputs
        )
        return replace(self, outputs=tuple(changed))
