"""What a block is: ports, states and memory, and formulas for them written once, over edges.

From the same formulas come the compiled program and the interpreted run. Which input feeds through to an output is read
off the formulas; nobody declares it. To add a block: a class in the folder of its category in `symofros/blocks/`, its
name in the `__init__` there and of `symofros/blocks/`, a section of docs/blocks.md (docs/architecture.md, "To add").
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from symofros.base.arguments import CheckedCalls
from symofros.base.arrays import Array
from symofros.description import System
from symofros.diagrams.settings import Plot
from symofros.diagrams.tensor import Tensor
from symofros.expr import Graph
from symofros.runtime.record import ModelRecord
from symofros.simulation.analysis.state_space import StateSpace
from symofros.simulation.inputs import Signal

Shape = tuple[int, ...]
Values = Mapping[str, Tensor]


@dataclass(frozen=True)
class Port(metaclass=CheckedCalls):
    """Where a signal enters or leaves.

    Attributes:
        name: Name.
        shape: Shape of the signal; None as long as nothing that is connected tells.
        unit: Such as "rad/s"; "" where any will do.
        default: Value of an input where nothing is connected, a number for all entries; None: it must be connected.
        units: Units along the last axis of a signal whose entries have not all the same one, in place of `unit`.
        signals: Of a bus: the signals that lie in it, one after the other.
    """

    name: str
    shape: Shape | None = ()
    unit: str = ""
    default: Any = field(default=None, compare=False)  # Arrays have no single answer to whether they are equal.
    units: tuple[str, ...] = ()
    signals: tuple[Port, ...] = ()

    @property
    def entry_units(self) -> tuple[str, ...]:
        """Units along the last axis; one, of a signal whose entries have all the same."""
        return self.units or (self.unit,)


@dataclass(frozen=True)
class Ports(metaclass=CheckedCalls):
    """All ports of a block, in order."""

    inputs: tuple[Port, ...] = ()
    outputs: tuple[Port, ...] = ()


class Environment(Protocol):
    """Known surroundings of a block while its ports are determined."""

    @property
    def inputs(self) -> Mapping[str, Shape]:
        """Shapes of the signals at its inputs, as far as they are known."""
        ...

    @property
    def units(self) -> Mapping[str, tuple[str, ...]]:
        """Units of the signals at its inputs, as far as they are known: `entry_units` of the sources."""
        ...

    @property
    def buses(self) -> Mapping[str, tuple[Port, ...]]:
        """Signals of the buses at its inputs, as far as they are known: `signals` of the sources."""
        ...

    def model(self, name: str) -> ModelRecord:
        """Sizes and names of a model of the diagram.

        Raises:
            DescriptionError: The diagram has no such model.
        """
        ...

    def start(self, name: str) -> tuple[Array, Array]:
        """The first q (nq) and v (nv) of a model."""
        ...

    def frame(self, model: str, frame: str) -> str:
        """The public name of a model's frame.

        Raises:
            DescriptionError: The model has no such frame.
        """
        ...

    def linear(self, name: str, u: Array) -> StateSpace:
        """A model linearised about its first state and inputs u (nu), on its constraints."""
        ...

    def imbalance(self, name: str, u: Array) -> tuple[str, float]:
        """The speed that changes most where `linear` linearises, and its acceleration; "" and 0 at a rest."""
        ...

    def momentum(self, name: str) -> Array:
        """The momentum M v (nv) of a model at its first state."""
        ...

    def system(self, name: str) -> System:
        """The description of a model."""
        ...

    def parameters(self, name: str) -> Array:
        """The values of a model's run-time parameters (npar), as the diagram states them."""
        ...

    def has_friction(self, model: str) -> list[bool]:
        """Which speeds (nv) of a model have friction."""
        ...

    def has_elastic_beams(self, model: str) -> bool:
        """Whether a model has beams that bend or twist."""
        ...


@dataclass(frozen=True)
class Terms:
    """How a mechanism moves.

    Attributes:
        a: Accelerations v' (nv) of a mechanism without constraints.
        M: Else M a = r + G^T lam, G a = c: (nv, nv). Beside accelerations it serves the judgement of elastic beams.
        r: (nv).
        G: (nc, nv).
        c: (nc), Baumgarte's terms with the gains of `EvaluationContext.gains` included.
        phi: Residual of each condition (nc), zero for those on speeds only.
        rate: G v - b (nc).
        facing: Cosines of the angles between axes of closures that are to be parallel; 1 for those that do not hold.
    """

    a: Tensor | None = None
    M: Tensor | None = None
    r: Tensor | None = None
    G: Tensor | None = None
    c: Tensor | None = None
    phi: Tensor | None = None
    rate: Tensor | None = None
    facing: Tensor | None = None

    def stated(self) -> dict[str, Tensor]:
        """Fields that are not None, by name."""
        return {item.name: value for item in fields(self) if (value := getattr(self, item.name)) is not None}


# The least normal number: a signal minus it is below zero unless the signal is above zero, so that 0 and 1 cross zero.
LEAST_ABOVE_ZERO = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True)
class Crossing:
    """A value whose zeros are located in time.

    Attributes:
        value: A scalar.
        direction: Direction of the crossings that count.
    """

    value: Tensor
    direction: Literal["both", "rising", "falling"] = "both"


@dataclass(frozen=True)
class EvaluationContext:
    """The point at which a block's formulas are written.

    Attributes:
        g: The graph.
        t: Time, a scalar.
        inputs: Input port -> its signal.
        states: Name -> continuous state.
        memory: Name -> what is kept from sample to sample.
        parameters: Field -> its value, which may change between runs.
        q: Configuration of the block's mechanism.
        v: Speeds (nv).
        gains: Baumgarte's (2 nc).
        call: (model, function, frame, groups) -> outputs of a model's function.
        solved: (M, r) -> M^-1 r for a mass matrix.
        a: Accelerations v' of the block's mechanism; under constraints known at samples and afterwards only.
        lam: Multipliers of the constraints of the block's mechanism (nc), known as `a` is.
        environment: Models and their first states.
    """

    g: Graph
    t: Tensor
    inputs: Values
    states: Values
    memory: Values
    parameters: Values
    q: Tensor
    v: Tensor
    gains: Tensor
    call: Callable[..., dict[str, Tensor]]
    solved: Callable[[Tensor, Tensor], Tensor]
    a: Tensor
    lam: Tensor
    environment: Environment

    def numbers(self, values: Any) -> Tensor:
        """An array of numbers."""
        return Tensor.numbers(self.g, values)


@dataclass(frozen=True, kw_only=True)
class Block(metaclass=CheckedCalls):
    """One block of a diagram; its fields are what its form asks for.

    Attributes:
        name: Unique in its diagram: letters, digits and underscores.
        period: Seconds between samples; None: continuous.
        offset: Time of the first sample [s]; until then outputs are zero.
    """

    name: str
    period: float | None = None
    offset: float = 0.0

    # Fields that become run-time parameters: tuned without compiling again.
    tunable: ClassVar[tuple[str, ...]] = ()
    # Fields of text that name files: in a diagram's file relative to it, and inside its folder.
    paths: ClassVar[tuple[str, ...]] = ("file",)

    def ports(self, environment: Environment) -> Ports:
        """The block's ports; called again while shapes of its inputs become known."""
        return Ports()

    def mechanism(self) -> str:
        """Name of the model that this block moves; "" for none."""
        return ""

    def lock_inputs(self) -> tuple[str, ...]:
        """Inputs that engage and release constraints; held between samples, and a change projects the state at once."""
        return ()

    def mechanism_events(self) -> Mapping[str, Any]:
        """Events of the mechanism, as `sf.simulate` takes them: name -> formula or Event."""
        return {}

    def states(self, environment: Environment) -> Mapping[str, Any]:
        """Continuous states -> their first values."""
        return {}

    def memory(self, environment: Environment) -> Mapping[str, Any]:
        """Stored quantity -> its initial value."""
        return {}

    def memory_at_start(self, context: EvaluationContext) -> Values:
        """Memory that begins by what signals are -> its value at the start, after the first samples."""
        return {}

    def notes(self, environment: Environment) -> Iterable[str]:
        """What the block takes for granted and the diagram does not have, in words: notes of each run."""
        return ()

    def keeps_instants(self) -> bool:
        """Whether its memory holds instants, from which time passes whether it runs or not."""
        return False

    def samples(self) -> Mapping[str, Signal]:
        """Outputs that are given by samples over time, one signal (n) or (n, size) each."""
        return {}

    def compute(self, context: EvaluationContext) -> Values:
        """Output port -> its signal, except those of `samples`."""
        return {}

    def rates(self, context: EvaluationContext) -> Values:
        """Continuous state -> its rate of change."""
        return {}

    def update(self, context: EvaluationContext) -> Values:
        """Stored quantity -> its value after a sample."""
        return {}

    def motion(self, context: EvaluationContext) -> Terms:
        """Accelerations of the block's mechanism, or else the terms of its constrained equations of motion."""
        return Terms()

    def crossings(self, context: EvaluationContext) -> Mapping[str, Crossing]:
        """Values whose zeros are located."""
        return {}

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """Memory and continuous states, "q" and "v" of its mechanism included, that a crossing changes."""
        return {}

    def reaches(self) -> str:
        """The address of another machine that the block would talk to; "" for none."""
        return ""

    def shown(self) -> tuple[Plot, ...]:
        """Pictures that it asks for; their signals are ports of its own."""
        return ()

    def parameters(self) -> dict[str, Array]:
        """Run-time parameter -> value."""
        return {name: np.asarray(getattr(self, name), dtype=np.float64) for name in self.tunable}

    def with_parameters(self, values: Mapping[str, Any]) -> Block:
        """The same with other values of run-time parameters, named as `parameters` names them.

        Raises:
            DescriptionError: The block refuses them.
        """
        return replace(self, **values)

    @classmethod
    def form(cls) -> tuple[str, ...]:
        """The fields that a file may state besides name, period and offset."""
        return tuple(item.name for item in fields(cls) if item.name not in ("name", "period", "offset"))


@dataclass(frozen=True)
class ModelFile:
    """Where a model was read from.

    Attributes:
        path: The file.
        functions: Functions as of `Diagram.add_model`.
        reading: Arguments of `sf.load` that it was read by.
    """

    path: str
    functions: int | None = None
    reading: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ModelSetup:
    """A model of a diagram: the paper's initialisation.

    Attributes:
        system: Description of the mechanism.
        start: Coordinate, or d and a speed's name -> first value; zero for the others.
        parameters: Run-time parameter -> value, where not the description's own.
        file: File that it was read from, if any.
    """

    system: System
    start: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    file: ModelFile | None = field(default=None, compare=False)
