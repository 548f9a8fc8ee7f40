"""Advice: what was left out and why, what was not and why, what is saved, how exact it still is."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from symofros.base.options import Options
from symofros.base.stored import write_atomically
from symofros.description import YAML_SUFFIXES, System
from symofros.description.yaml import write_yaml
from symofros.errors import DescriptionError, UnknownNameError, did_you_mean
from symofros.studio.advice.scene import Scene
from symofros.studio.advice.scene_runner import Cost, Stepping

Verdict = Literal["taken", "refused", "not tried"]


@dataclass(frozen=True)
class Choice:
    """One reduction, judged.

    Attributes:
        subject: Part of the model, such as "beam 'link1'".
        change: Change made to it, such as "rigid".
        kind: Kind of the reduction, such as "foreshortening".
        verdict: "taken", "refused" by simulation, or "not tried", because the estimate is far beyond what is allowed.
        estimate: Expected error, in units of what is allowed.
        error: Error of the simulation with it, with all that was taken before, and with what was taken in the same
            go, in the same units; None: not simulated.
        why: Reason, with numbers.
        numbers: The estimators' numbers.
    """

    subject: str
    change: str
    kind: str
    verdict: Verdict
    estimate: float
    error: float | None
    why: str
    numbers: Mapping[str, float]

    def __str__(self) -> str:
        """One line."""
        measured = "" if self.error is None else f", simulated {self.error:.3g}"
        return f"{self.verdict}: {self.subject} {self.change}: {self.why} (estimate {self.estimate:.3g}{measured})"


@dataclass(frozen=True)
class Advice:
    """The cheapest model found for a scene.

    Attributes:
        scene: Scene that the advice is for.
        full: The system as it was described; with geometrically exact rods where it leaves the theory of its beams.
        system: The reduced one.
        stepping: How to step it; `full_stepping` is the cheapest way to step the full one as exactly.
        cost: Cost of a run; `full_cost` of the full one, stepped by `full_stepping`.
        choices: Every reduction judged.
        errors: Output's name -> error of the reduced model as it is stepped, against the richer one, in units of what
            is allowed.
        bounds: Output's name -> what is allowed, in its own unit.
        truncation: Error of the full model against the richer one, in units of what is allowed.
        unsettled: What functions beyond those of the richer model may still change, in the same units.
        options: The functions to generate, and the frames.
        methods: A line on each integrator tried.
        runs: Number of simulations it took.
        notes: Further remarks.
    """

    scene: Scene
    full: System
    system: System
    stepping: Stepping
    full_stepping: Stepping
    cost: Cost
    full_cost: Cost
    choices: tuple[Choice, ...]
    errors: Mapping[str, float]
    bounds: Mapping[str, float]
    truncation: float
    unsettled: float
    options: Options
    methods: tuple[str, ...]
    runs: int
    notes: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every output is within its tolerance, and stays so whatever the richer model still changes by."""
        return all(share + self.unsettled <= 1.0 for share in self.errors.values())

    @property
    def gain(self) -> float:
        """Operations of a run of the full model over those of the reduced one."""
        return self.full_cost.total / max(1, self.cost.total)

    def choice(self, kind: str, subject: str = "") -> Choice:
        """The first choice of a kind, about a subject whose text has this in it.

        Raises:
            UnknownNameError: There is none.
        """
        for one in self.choices:
            if one.kind == kind and subject in one.subject:
                return one
        listed = ", ".join(dict.fromkeys(one.kind for one in self.choices)) or "none"
        what, rule = f"no choice of kind '{kind}' about '{subject}'", "a choice has a kind and a subject"
        raise UnknownNameError(what, f"kinds: {listed}", rule, "see `choices`")

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the reduced system as native YAML, headed by what was left out.

        Args:
            path: Ends in .yaml or .yml.

        Raises:
            DescriptionError: Another suffix, or something that the format can't hold.
        """
        file = Path(path)
        if file.suffix.lower() not in YAML_SUFFIXES:
            raise DescriptionError(
                f"'{file}' can't be written: unknown format",
                file.suffix or "no suffix",
                f"the suffix is one of {', '.join(YAML_SUFFIXES)}",
                did_you_mean(file.suffix.lower(), YAML_SUFFIXES),
            )
        head = [f"Reduced from '{self.full.name}' for one scene of {self.scene.t_end:g} s.", *self.summary()]
        head += [str(one) for one in self.choices if one.verdict == "taken"]
        comment = "".join(f"# {line}\n" for text in head for line in text.splitlines())
        write_atomically(file, comment + write_yaml(self.system))

    def summary(self) -> list[str]:
        """Recommended stepping, error of each output, and cost of a run, a line each."""
        lines = [f"step it by {self.stepping}; functions: {', '.join(self.options.functions or ())}"]
        for name, share in self.errors.items():
            bound = self.bounds[name]
            beside = f" beside a model that may itself be off by {self.unsettled * bound:.3g}" if self.unsettled else ""
            lines.append(f"output '{name}': error {share * bound:.3g}{beside}, allowed {bound:.3g}")
        lines.append(
            f"{self.cost.total} operations a run ({self.cost.per_evaluation} x {self.cost.evaluations} evaluations"
            + (f", {self.cost.per_jacobian} x {self.cost.jacobians} derivatives" if self.cost.jacobians else "")
            + f"); {self._beside}"
        )
        return lines

    @property
    def _beside(self) -> str:
        """Cost of the full model: over that of the reduced one, or with its error where that exceeds the tolerance."""
        taken = f"takes {self.full_cost.total} ({self.full_stepping})"
        if self.truncation > 1.0:
            return f"the full model {taken}, and errs by {self.truncation:.3g} of what is allowed"
        return f"the full model {taken}: {self.gain:.1f} times as many"

    def __str__(self) -> str:
        """Human-readable summary, without a table."""
        return "\n".join([f"{self.full.name}:", *(f"  {one}" for one in self.choices), *self.summary(), *self.notes])

    def to_json(self) -> dict[str, Any]:
        """The advice for programs: what `symofros advise --json` prints. An infinite error is null."""
        return {
            "ok": self.ok,
            "model": self.full.name,
            "gain": self.gain,
            "cost": _cost(self.cost),
            "full_cost": _cost(self.full_cost),
            "stepping": str(self.stepping),
            "full_stepping": str(self.full_stepping),
            "functions": list(self.options.functions or ()),
            "frames": list(self.options.frames or ()),
            "outputs": [
                {"name": name, "error": _finite(share * self.bounds[name]), "allowed": self.bounds[name]}
                for name, share in self.errors.items()
            ],
            "truncation": self.truncation,
            "unsettled": self.unsettled,
            "choices": [
                {
                    "subject": one.subject,
                    "change": one.change,
                    "kind": one.kind,
                    "verdict": one.verdict,
                    "estimate": _finite(one.estimate),
                    "error": _finite(one.error),
                    "why": one.why,
                    "numbers": {key: _finite(value) for key, value in one.numbers.items()},
                }
                for one in self.choices
            ],
            "methods": list(self.methods),
            "runs": self.runs,
            "notes": list(self.notes),
        }


def _cost(cost: Cost) -> dict[str, float]:
    return {
        "operations": cost.total,
        "per_evaluation": cost.per_evaluation,
        "evaluations": cost.evaluations,
        "per_jacobian": cost.per_jacobian,
        "jacobians": cost.jacobians,
        "seconds": cost.seconds,
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or not abs(value) < float("inf") else value
