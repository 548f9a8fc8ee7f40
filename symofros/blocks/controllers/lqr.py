"""The linear quadratic regulator about a model's first state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import numbers, refuse, weights
from symofros.blocks.controllers.riccati import continuous_gain, held_gain
from symofros.blocks.manifold import difference
from symofros.blocks.quantities import entry_units, motion_port, with_units
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import joined


@dataclass(frozen=True, kw_only=True)
class LQR(Block):
    """u = u_0 - K x, x = (difference of q along the manifold, v - v_d), K least in int x^T Q x + u^T R u.

    The model is linearised about its first state, exactly, once, as the block is written out. Sampled, K is the least
    of that integral with inputs held over the period, whatever x does between samples. On constraints x is taken along
    the motions that they leave. Parameters changed for a run do not change K.

    Attributes:
        model: The model; at its first state with inputs u_0 it should be at rest, else runs say so.
        state_weights: Q: one, one an entry of x (2 nv), or a matrix.
        input_weights: R: one, one an input (nu), or a matrix, positive.
        nominal: u_0 (nu); None: the model's default inputs.
    """

    model: str
    state_weights: Any = 1.0
    input_weights: Any = 1.0
    nominal: Any = None

    def ports(self, environment: Environment) -> Ports:
        """Actual q, v, and desired ones, the first state by default, in; u (nu) and x (2 nv) out."""
        record = environment.model(self.model)
        nv, nu = len(record.v_names), len(record.u_names)
        if not nu:
            raise refuse(
                self.name,
                "nothing to control",
                f"model '{self.model}' has no inputs",
                "a regulated model has inputs",
                "actuate a joint",
            )
        if self.nominal is not None:
            numbers(self.name, "nominal", self.nominal, (nu,))
        weights(self.name, "state_weights", self.state_weights, 2 * nv)
        weights(self.name, "input_weights", self.input_weights, nu, positive=True)
        q0, v0 = environment.start(self.model)
        inputs = (
            motion_port("q", record, "q"),
            motion_port("v", record, "v"),
            motion_port("q_desired", record, "q", tuple(q0)),
            motion_port("v_desired", record, "v", tuple(v0)),
        )
        # Differences of configurations: of rotations, rotation vectors.
        turns = tuple(unit.removesuffix("/s") for unit in entry_units(record, "v"))
        x = with_units(Port("x", (2 * nv,)), (*turns, *entry_units(record, "v")))
        return Ports(inputs, (motion_port("u", record, "u"), x))

    def _nominal(self, environment: Environment) -> Array:
        given = environment.model(self.model).u_default if self.nominal is None else self.nominal
        return np.asarray(given, dtype=np.float64)

    def gain(self, environment: Environment) -> Array:
        """K (nu, 2 nv).

        Raises:
            DescriptionError: Nothing stabilises the model.
        """
        linear = environment.linear(self.model, self._nominal(environment))
        Q = weights(self.name, "state_weights", self.state_weights, len(linear.basis))
        R = weights(self.name, "input_weights", self.input_weights, linear.B.shape[1], positive=True)
        Q = linear.basis.T @ Q @ linear.basis
        if self.period is None:
            K = continuous_gain(linear.A, linear.B, Q, R)
        else:
            K = held_gain(linear.A, linear.B, Q, R, self.period)
        if K is None:
            raise refuse(
                self.name,
                "no gain",
                f"model '{self.model}' about its first state",
                "inputs reach every motion that does not die out, and weights see it",
                "actuate more joints, damp what is out of reach, weigh all states",
            )
        return K @ linear.basis.T

    def notes(self, environment: Environment) -> tuple[str, ...]:
        """Notes on a first state that is no rest: the gain is one about it, and holds the model beside the target."""
        speed, a = environment.imbalance(self.model, self._nominal(environment))
        note = (
            f"model '{self.model}' is not at rest in its first state with the nominal inputs: '{speed}' accelerates by"
            f" {a:.3g}; the gain is about a state that does not stay; start from sf.equilibrium, or state the inputs"
            " that hold it"
        )
        return (note,) if speed else ()

    def compute(self, context: EvaluationContext) -> Values:
        """The gain on the state's error."""
        record, inputs = context.environment.model(self.model), context.inputs
        x = joined([difference(record, inputs["q_desired"], inputs["q"]), inputs["v"] - inputs["v_desired"]])
        return {"u": self._nominal(context.environment) - context.numbers(self.gain(context.environment)) @ x, "x": x}
