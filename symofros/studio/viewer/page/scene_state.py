"""The picture as it stands: which mechanism, in which state, how it is drawn. One thread at a time may use it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import UnknownNameError, did_you_mean
from symofros.studio.viewer.drawing.drawing import Drawing, same_geometry
from symofros.studio.viewer.drawing.layers import initial_layers
from symofros.studio.viewer.drawing.poses import Mechanism, Posture, State
from symofros.studio.viewer.page.viser_scene import ViserScene
from symofros.studio.viewer.playing.run_forces import RunForces
from symofros.studio.viewer.playing.signals import coordinate_units
from symofros.studio.viewer.playing.sliders import Slider, coordinates_of, sliders_of, values_of

Acting = tuple[RunForces, float]
"""Forces of a run, and the time that is shown [s]."""


class SceneState:
    """A mechanism on a server; `posture` is the one that is shown.

    Args:
        server: Server of viser.
        mechanism: Mechanism that is shown.
        exaggeration: Factor of its elastic coordinates.
        on_pick: Called with the element that somebody clicks in the picture.
    """

    def __init__(
        self, server: Any, mechanism: Mechanism, exaggeration: float, on_pick: Callable[[str], None] | None = None
    ) -> None:
        self.server, self.mechanism, self.exaggeration = server, mechanism, exaggeration
        self._on_pick = on_pick
        self.first = self.state = mechanism.closed(mechanism.state())[0]
        self._acting: Acting | None = None
        drawing = mechanism.drawing(self.state.par)
        self._drawn_par = self.state.par
        self.posture = self._posture()
        self.scene = ViserScene(server, drawing, self.posture, initial_layers(drawing), on_pick=on_pick)

    def change(self, mechanism: Mechanism) -> None:
        """Show another mechanism; where it has the same coordinates, they stay, and so do the layers shown."""
        kept = self.state.q if mechanism.model.names.q == self.mechanism.model.names.q else None
        self.mechanism = mechanism
        self.first = mechanism.closed(mechanism.state())[0]
        self._acting = None
        self.state = self.first if kept is None else mechanism.closed(self.first._replace(q=kept))[0]
        self._draw(mechanism.drawing(self.state.par))

    def paint(self, state: State, acting: Acting | None = None) -> bool:
        """Show a state; False where it is not finite, and the picture stays.

        The mechanism is drawn anew where parameters have changed how it looks.

        Args:
            state: The state.
            acting: Forces of the run that it is of, and its time; None of a state of no run.
        """
        if not all(np.all(np.isfinite(array)) for array in state):
            return False
        self.state, self._acting = state, acting
        if not np.array_equal(state.par, self._drawn_par):
            drawing = self.mechanism.drawing(state.par)
            if not same_geometry(drawing, self.scene.drawing):
                self._draw(drawing)
                return True
            self._drawn_par = state.par
        self._move()
        return True

    def repaint(self, acting: Acting | None = None) -> None:
        """Show the same state anew, with other forces where they are given."""
        self._acting = acting or self._acting
        self._move()

    def _move(self) -> None:
        self.posture, arrows = self._posture(), None
        if self._acting is not None:
            forces, t = self._acting
            arrows = forces.arrows(t, self.posture, self.scene.layers)
        self.scene.move(self.posture, arrows)

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Sliders of the mechanism: one per speed."""
        return sliders_of(self.mechanism.model, self.mechanism.elastic, coordinate_units(self.mechanism.tree))

    @property
    def values(self) -> Array:
        """Values of the sliders (nv)."""
        return values_of(self.mechanism.model, self.state.q)

    def with_sliders_moved(self, changes: Mapping[int, float], par: Array | None = None) -> tuple[State, str]:
        """The state with some sliders moved and the loops closed around them, and why they can't be: "" where they can.

        Args:
            changes: Values by the index of the slider.
            par: Run-time parameters (npar); those of the state by default.
        """
        model, values = self.mechanism.model, self.values
        for index, value in changes.items():
            values[index] = value
        guess = self.state._replace(q=coordinates_of(model, values), par=self.state.par if par is None else par)
        return self.mechanism.closed(guess, tuple(model.names.v[index] for index in changes))

    def by_name(self, values: Mapping[str, float], par: Mapping[str, float]) -> tuple[dict[int, float], Array]:
        """Changes of sliders by index, and run-time parameters (npar), of what is given by labels and names.

        Raises:
            UnknownNameError: There is no such slider or parameter.
            ParameterError: The description refuses the parameters.
        """
        chosen = self.state.par.copy()
        for name, value in par.items():
            chosen[_index("parameter", self.mechanism.model.names.par, name)] = value
        labels = [slider.label for slider in self.sliders]
        return {_index("coordinate", labels, name): value for name, value in values.items()}, (
            self.mechanism.model.checked_parameters(chosen)
        )

    def _posture(self) -> Posture:
        return self.mechanism.posture(self.state.q, self.state.u, self.state.par, self.exaggeration)

    def _draw(self, drawing: Drawing) -> None:
        """Redraw; visibility and marks are preserved."""
        self._drawn_par = self.state.par
        marked = self.scene.marked
        self.scene = ViserScene(self.server, drawing, self._posture(), self.scene.layers, marked, self._on_pick)
        self._move()


def _index(what: str, names: Sequence[str], name: str) -> int:
    if name not in names:
        raise UnknownNameError(
            f"view: no {what} '{name}'", ", ".join(names[:12]), f"a {what} of the model", did_you_mean(name, names)
        )
    return names.index(name)
