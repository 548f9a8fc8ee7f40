"""The picture as it stands: which mechanism, in which state, how it is drawn. One thread at a time may use it."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.viewing.drawing import Drawing, alike
from symofros.viewing.poses import Mechanism, Posture, State
from symofros.viewing.scene import Scene, shown_at_first
from symofros.viewing.shapes import Array
from symofros.viewing.sliders import coordinates_of, values_of


class Stage:
    """A mechanism on a server.

    Args:
        server: Of viser.
        mechanism: What is shown.
        exaggeration: What multiplies its elastic coordinates.
    """

    def __init__(self, server: Any, mechanism: Mechanism, exaggeration: float) -> None:
        self.server, self.mechanism, self.exaggeration = server, mechanism, exaggeration
        self.first = self.state = mechanism.closed(mechanism.state())[0]
        drawing = mechanism.drawing(self.state.par)
        self._drawn_par = self.state.par
        self.scene = Scene(server, drawing, self._posture(), shown_at_first(drawing))

    def change(self, mechanism: Mechanism) -> None:
        """Show another mechanism; where it has the same coordinates, they stay, and so do the layers shown."""
        kept = self.state.q if mechanism.model.names.q == self.mechanism.model.names.q else None
        self.mechanism = mechanism
        self.first = mechanism.closed(mechanism.state())[0]
        self.state = self.first if kept is None else mechanism.closed(self.first._replace(q=kept))[0]
        self._draw(mechanism.drawing(self.state.par))

    def paint(self, state: State) -> bool:
        """Show a state; False where it is not finite, and the picture stays.

        The mechanism is drawn anew where parameters have changed how it looks.
        """
        if not all(np.all(np.isfinite(array)) for array in state):
            return False
        self.state = state
        if not np.array_equal(state.par, self._drawn_par):
            drawing = self.mechanism.drawing(state.par)
            if not alike(drawing, self.scene.drawing):
                self._draw(drawing)
                return True
            self._drawn_par = state.par
        self.scene.move(self._posture())
        return True

    @property
    def values(self) -> Array:
        """Where the sliders of the state stand (nv)."""
        return values_of(self.mechanism.model, self.state.q)

    def slid(self, index: int, value: float) -> tuple[State, str]:
        """The state with one slider moved and the loops closed around it, and why they can't be: "" where they can."""
        model, values = self.mechanism.model, self.values
        values[index] = value
        return self.mechanism.closed(
            self.state._replace(q=coordinates_of(model, values)), (model.names.v[index],)
        )  # fmt: skip

    def _posture(self) -> Posture:
        return self.mechanism.posture(self.state.q, self.state.u, self.state.par, self.exaggeration)

    def _draw(self, drawing: Drawing) -> None:
        """Draw anew; what is shown or hidden stays so."""
        self._drawn_par = self.state.par
        self.scene = Scene(self.server, drawing, self._posture(), self.scene.layers)
