"""A handle at a frame: whoever drags it moves the mechanism by inverse kinematics."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.options import Options
from symofros.compiler import compile_system
from symofros.simulation.analysis.kinematics.inverse_kinematics import Target, inverse_kinematics
from symofros.studio.viewer.drawing.poses import Mechanism, State

_NAME, _SIZE = "/handle", 0.12  # Its arrows, of the mechanism's size.
_STEPS = 60


class FrameHandle:
    """Three arrows at a frame's origin.

    Args:
        server: Server of viser.
        mechanism: Mechanism that is shown.
        frame: Name of the frame.
        state: State that is shown.
        size: Extent of the mechanism [m].
        dragged: Called, in a thread of the server, when somebody has dragged the handle or let it go.

    Raises:
        UnknownNameError: There is no such frame.
    """

    def __init__(
        self, server: Any, mechanism: Mechanism, frame: str, state: State, size: float, dragged: Callable[[bool], None]
    ) -> None:
        self.mechanism, self.frame = mechanism, frame
        # The model of pictures has poses alone; functions of this one are interpreted until they are compiled.
        self.model = compile_system(mechanism.system, Options(background=True))
        self._is_dragged = False
        place = self._place(state)
        self.node = server.scene.add_transform_controls(
            _NAME, scale=_SIZE * size, disable_rotations=True, depth_test=False, position=place
        )

        def follow_hand(event: Any) -> None:
            self._is_dragged = event.phase != "end"
            dragged(not self._is_dragged)

        self.node.on_update(follow_hand)

    def reached(self, state: State) -> State:
        """The state nearest to the one shown in which the frame is where the handle is, or as near as it gets.

        Elastic coordinates stay: a hand that bends a beam is a force, not a posture.
        """
        model = self.model
        elastic = {name for name, bends in zip(model.names.q, self.mechanism.elastic, strict=True) if bends}
        found = inverse_kinematics(
            model,
            {self.frame: Target(position=np.array(self.node.position, dtype=np.float64))},
            state.q,
            held=[name for name in model.names.v if name in elastic],
            u=state.u,
            par=state.par,
            iterations=_STEPS,
            beam_limit=math.inf,
            starts=1,
        )
        return state._replace(q=found.q)

    def follow(self, state: State) -> None:
        """Put the handle where the frame is, unless somebody holds it."""
        if not self._is_dragged:
            self.node.position = self._place(state)

    def remove(self) -> None:
        """Take the handle out of the picture."""
        self.node.remove()

    def _place(self, state: State) -> Array:
        return np.asarray(self.model.frame_pose(self.frame, state.q, u=state.u, par=state.par)[0])
