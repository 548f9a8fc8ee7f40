"""What a campaign is asked to do: a strict TOML file, or options of the command line; and the batches it falls into."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from symofros.commands.reading import ReadingOptions

from .. import references
from ..adapters import require_engines
from ..checking import description_hash
from ..inputs.cases import Case, named
from .design import Design, Range, points_of
from .errors import PlanError

# A plan is a page; whoever sends more wants something else.
MAX_BYTES = 1 << 20
# Each batch is a file while the campaign runs.
MAX_BATCHES = 100_000

Count = Annotated[int, Field(ge=1, le=10**10)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _OfFiles(_Strict):
    """Options for reading the files of models, as of `sf.load` (docs/importing.md).

    Attributes:
        floating_base: Whether the body of a file that stands on the ground goes onto a free joint.
        waive: Checks that every body of a file may fail.
        packages: Name -> further folder that files may be read from.
        dissipation: What is kept of passive losses; "" for what the format keeps by default.
        limits: What limits of coordinates are.
    """

    floating_base: bool = False
    waive: tuple[str, ...] = ()
    packages: dict[str, str] = Field(default_factory=dict)
    dissipation: Literal["", "none", "viscous", "all"] = ""
    limits: Literal["data", "stops"] = "data"

    @property
    def reading(self) -> ReadingOptions:
        """Options for reading the model files."""
        return ReadingOptions(
            self.floating_base,
            waive=self.waive,
            packages=tuple(self.packages.items()),
            dissipation=self.dissipation,
            limits="" if self.limits == "data" else self.limits,
        )


class CheckPlan(_OfFiles):
    """Cross-check random states of many models.

    Attributes:
        kind: "check".
        models: Names of the standard set, or files below the current folder.
        states: Number of states in all, shared among the models.
        batch: States a batch.
        seed: Seed of the states.
        engines: Engines to compare with; None: all.
    """

    kind: Literal["check"] = "check"
    models: tuple[str, ...] = Field(min_length=1, max_length=1000)
    states: Count
    batch: Annotated[int, Field(ge=1, le=100_000)] = 500
    seed: Seed = 0
    engines: tuple[str, ...] | None = Field(default=None, min_length=1)

    @model_validator(mode="after")
    def _sound(self) -> CheckPlan:
        try:
            require_engines(self.engines or ())
        except LookupError as error:
            raise ValueError(error.args[0]) from None
        if self.states < len(self.models):
            raise ValueError(f"{self.states} states for {len(self.models)} models; each needs one")
        return self

    @property
    def size(self) -> int:
        """States in all."""
        return self.states


class Motion(_Strict):
    """Settings of the simulations in a sweep; see `sf.simulate_batch`."""

    t_end: Annotated[float, Field(gt=0.0, le=1e6)]
    dt: Annotated[float, Field(gt=0.0)] = 1e-3
    method: Literal["rk4", "semi_implicit_euler", "euler", "dopri5", "dop853"] = "rk4"


class SweepPlan(_OfFiles):
    """One model over many values of its parameters.

    Attributes:
        kind: "sweep".
        model: A name of the standard set, or a file below the current folder.
        quantity: "frequencies" of small motions about the equilibrium, or "end_state" of a motion.
        over: Parameter or input -> the values it takes.
        design: Design of the sweep: every value with every other, or a Latin hypercube or Sobol sequence.
        points: Number of points, unless the design is a grid.
        batch: Points a batch.
        seed: Seed of the spread.
        modes: Number of frequencies, from the lowest.
        start: Coordinate or speed -> its value at the start, or near the equilibrium; others are neutral.
        held: Speeds whose coordinates stay where they are while the equilibrium is sought.
        inputs: Input -> value; others are zero.
        motion: Motion that "end_state" is the end of.
    """

    kind: Literal["sweep"]
    model: str
    quantity: Literal["frequencies", "end_state"]
    over: dict[str, Range] = Field(min_length=1, max_length=50)
    design: Design = "grid"
    points: Annotated[int, Field(ge=1, le=10**6)] | None = None
    batch: Annotated[int, Field(ge=1, le=100_000)] = 64
    seed: Seed = 0
    modes: Annotated[int, Field(ge=1, le=100)] = 3
    start: dict[Literal["q", "v"], dict[str, float]] = Field(default_factory=dict)
    held: tuple[str, ...] = ()
    inputs: dict[str, float] = Field(default_factory=dict)
    motion: Motion | None = None

    @model_validator(mode="after")
    def _sound(self) -> SweepPlan:
        if (self.motion is None) != (self.quantity == "frequencies"):
            raise ValueError("'motion' belongs to quantity 'end_state', which needs it")
        idle = {"modes", "held"} & self.model_fields_set
        if idle and self.motion is not None:
            raise ValueError(f"'{min(idle)}' belongs to quantity 'frequencies'")
        twice = sorted(self.over.keys() & self.inputs.keys())
        if twice:
            raise ValueError(f"'{twice[0]}' is swept and stated among 'inputs': state it once")
        points_of(self.over, self.design, self.points, self.seed, 0, 0)  # Says what is wrong with the design.
        return self

    @property
    def size(self) -> int:
        """Points in all."""
        return len(points_of(self.over, self.design, self.points, self.seed))


Plan = CheckPlan | SweepPlan
_PLANS: TypeAdapter[Plan] = TypeAdapter(Annotated[CheckPlan | SweepPlan, Field(discriminator="kind")])


def read(path: Path) -> Plan:
    """The plan of a TOML file.

    Raises:
        PlanError: It is no legal plan.
        OSError: The file can't be read.
    """
    with path.open("rb") as stream:
        text = stream.read(MAX_BYTES + 1)
    if len(text) > MAX_BYTES:
        raise PlanError(
            path.name, f"more than {MAX_BYTES} bytes", "a plan is a short TOML file", "see docs/campaigns.md"
        )
    try:
        return make(tomllib.loads(text.decode("utf-8")), path.name)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise PlanError(path.name, str(error), "a plan is a TOML file", "see docs/campaigns.md") from None


def make(data: dict[str, Any], where: str) -> Plan:
    """The plan of plain data, which needs a `kind`.

    Raises:
        PlanError: It is no legal plan.
    """
    try:
        plan = _PLANS.validate_python(data)
    except ValidationError as error:
        lines = [f"{'.'.join(map(str, e['loc']))}: {e['msg']}".lstrip(": ") for e in error.errors()]
        raise PlanError(
            where, "; ".join(lines), "docs/campaigns.md lists what a plan says", "mend these entries"
        ) from None
    batches = -(-plan.size // plan.batch)
    if batches > MAX_BATCHES:
        remedy = f"batch = {-(-plan.size // MAX_BATCHES)} or more"
        raise PlanError(where, f"{batches} batches", f"at most {MAX_BATCHES}: each is a file for a while", remedy)
    return plan


def as_text(plan: Plan) -> str:
    """The same plan, the same text."""
    return json.dumps(plan.model_dump(mode="json"), sort_keys=True)


def cases(plan: Plan) -> list[Case]:
    """The plan's models, one label each.

    Raises:
        PlanError: There is no such model, or one is named twice.
    """
    names = [plan.model] if isinstance(plan, SweepPlan) else list(plan.models)
    try:
        chosen = named(names, plan.reading)
    except (LookupError, OSError) as error:
        rule = "a model is a name of the standard set, or a file below the folder that the command runs in"
        raise PlanError("models", str(error.args[0]), rule, "mend the name") from None
    for case in chosen:
        if case.path is not None and not case.path.is_file():
            rule = "a model's file stays where it is until the campaign is done"
            raise PlanError("models", f"no file {case.path}", rule, "run in the folder that the path starts from")
    if len({case.label for case in chosen}) < len(names):
        raise PlanError(
            "models", ", ".join(names), "each model is named once", "leave out the second, or rename a file"
        )
    return chosen


def identities(models: Sequence[Case]) -> dict[str, str]:
    """Label -> hash of the model's file or description."""
    return {case.label: _identity(case) for case in models}


def _identity(case: Case) -> str:
    if case.path is None:
        return description_hash(references.MODELS[case.label])
    return hashlib.sha256(case.path.read_bytes()).hexdigest()[:16]


def plan_hash(plan: Plan, models: dict[str, str]) -> str:
    """Hash that identifies a plan together with the models that it applies to."""
    return hashlib.sha256(f"{as_text(plan)}\n{json.dumps(models, sort_keys=True)}".encode()).hexdigest()[:16]
