"""What a block knows of its diagram while its ports are determined: `Environment` of block.py."""

from __future__ import annotations

from collections.abc import Mapping

from symofros.base.arrays import Array
from symofros.description import System
from symofros.diagrams.block import Port, Shape
from symofros.diagrams.program.model_environment import Models
from symofros.runtime.record import ModelRecord
from symofros.simulation.analysis.state_space import StateSpace


class Surroundings:
    """Surroundings of a block while its ports are determined."""

    def __init__(
        self,
        models: Models,
        inputs: Mapping[str, Shape],
        units: Mapping[str, tuple[str, ...]],
        buses: Mapping[str, tuple[Port, ...]],
    ) -> None:
        self._models, self._inputs, self._units, self._buses = models, inputs, units, buses

    @property
    def inputs(self) -> Mapping[str, Shape]:
        """Shapes of the signals at its inputs, as far as they are known."""
        return self._inputs

    @property
    def units(self) -> Mapping[str, tuple[str, ...]]:
        """Units of these signals, as far as they are known."""
        return self._units

    @property
    def buses(self) -> Mapping[str, tuple[Port, ...]]:
        """Signals of the buses at its inputs, as far as they are known."""
        return self._buses

    def model(self, name: str) -> ModelRecord:
        """Sizes and names of a model."""
        return self._models.record(name)

    def start(self, name: str) -> tuple[Array, Array]:
        """The first q (nq) and v (nv) of a model."""
        return self._models.own_start(name)

    def frame(self, model: str, frame: str) -> str:
        """The public name of a model's frame."""
        return self._models.frame(model, frame)

    def linear(self, name: str, u: Array) -> StateSpace:
        """A model linearised about its first state and inputs u (nu)."""
        return self._models.linear(name, u)

    def imbalance(self, name: str, u: Array) -> tuple[str, float]:
        """The speed that changes most where `linear` linearises, and its acceleration; "" and 0 at a rest."""
        return self._models.imbalance(name, u)

    def momentum(self, name: str) -> Array:
        """The momentum M v (nv) of a model at its first state."""
        return self._models.momentum(name)

    def system(self, name: str) -> System:
        """The description of a model."""
        return self._models.system(name)

    def parameters(self, name: str) -> Array:
        """The run-time parameters of a model (npar)."""
        return self._models.parameters(name)

    def has_friction(self, model: str) -> list[bool]:
        """Which speeds (nv) of a model have friction."""
        return self._models.has_friction(model)

    def has_elastic_beams(self, model: str) -> bool:
        """Whether a model has beams that bend or twist."""
        return self._models.has_elastic_beams(model)
