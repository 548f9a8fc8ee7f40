"""The picture in the browser with its controls: what is drawn, played, moved by sliders; for any thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.beams import BeamBending, bending_notes
from symofros.studio.viewer.drawing.layers import ARROWS
from symofros.studio.viewer.drawing.poses import Mechanism, State
from symofros.studio.viewer.page.cameras import CameraFollow
from symofros.studio.viewer.page.frame_handle import FrameHandle
from symofros.studio.viewer.page.ghost_scene import GhostScene
from symofros.studio.viewer.page.panel import Panel
from symofros.studio.viewer.page.scene_state import Acting, SceneState
from symofros.studio.viewer.playing.ghosts import Ghost
from symofros.studio.viewer.playing.motion import finite, positive
from symofros.studio.viewer.playing.player import Player
from symofros.studio.viewer.playing.run_forces import RunForces
from symofros.studio.viewer.playing.signals import Signal
from symofros.studio.viewer.playing.sliders import Slider

_DARK_LIGHT = 5.0  # Before a dark ground viser's own light is too weak for the bodies' colours.
_FOLLOWED = 0.1  # Seconds between updates of the controls: they cost more than the picture.


class ViewerPage:
    """A mechanism on a server, and the controls beside it.

    Args:
        server: Server of viser.
        mechanism: Mechanism that is shown.
        exaggeration: Factor of the elastic coordinates.
        controls: Whether there are sliders and buttons.
        on_pick: Called with the element that somebody clicks in the picture.

    Attributes:
        painted: Number of pictures shown.
        bendings: Bending of each beam in the state that the controls stand at, as far as it is judged.
    """

    def __init__(
        self,
        server: Any,
        mechanism: Mechanism,
        exaggeration: float,
        controls: bool,
        on_pick: Callable[[str], None] | None = None,
    ) -> None:
        self._server, self._controls = server, controls
        self._painting = threading.RLock()  # Guards the picture, the player and the controls.
        self._player: Player | None = None
        self._followed = -_FOLLOWED
        self._dark = False
        self._light: Any = None  # Beside viser's own, in the dark.
        self.painted = 0
        self._scene_state = SceneState(server, mechanism, exaggeration, on_pick)
        self._height: float | None = None
        self._forces: RunForces | None = None  # Of the run that plays, once they are shown.
        self._ghosts: tuple[Ghost, ...] = ()
        self._ghost_scene: GhostScene | None = None
        self._camera_follow: CameraFollow | None = None
        self._signals: tuple[Signal, ...] = ()
        self._handle: FrameHandle | None = None
        self._on_drag: Callable[[], None] | None = None
        self.bendings: tuple[BeamBending, ...] = ()
        self._panel = self._new_panel()
        self._judge_bending()

    @property
    def mechanism(self) -> Mechanism:
        """The displayed mechanism."""
        return self._scene_state.mechanism

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self._scene_state.state

    @property
    def exaggeration(self) -> float:
        """Factor of elastic coordinates in the picture."""
        return self._scene_state.exaggeration

    @exaggeration.setter
    def exaggeration(self, factor: float) -> None:
        self.set_exaggeration(factor)

    # What the controls on the page do.

    def toggle(self) -> None:
        """Play or pause the motion."""
        with self._painting:
            if self._player is not None:
                if self._player.playing:
                    self._player.playing = False
                else:
                    self._player.start()
                self._follow()

    def seek(self, time: float) -> None:
        """Go to a time of the motion [s]."""
        with self._painting:
            if self._player is not None:
                self._player.seek(time)
                self._paint_motion()

    def set_speed(self, speed: float) -> None:
        """Play the motion at so many seconds a second."""
        with self._painting:
            if self._player is not None:
                self._player.speed = positive("speed", speed)

    @property
    def layers(self) -> frozenset[str]:
        """Layers that are shown."""
        return self._scene_state.scene.layers

    def set_layer(self, layer: str, visible: bool) -> None:
        """Show or hide a layer.

        Args:
            layer: "bodies", "inertias", "joints", "constraints", "paths", "visuals", "frames", "labels", "ground"; and
                "forces" or "moments", arrows at joints, constraints and contacts of a trajectory that plays.
            visible: Whether it is to be seen.

        Raises:
            UnknownNameError: There is no such layer.
        """
        with self._painting:
            self._scene_state.scene.show(layer, visible)
            if self._ghost_scene is not None:
                self._ghost_scene.show(layer, visible)
            if layer in ARROWS:
                self._scene_state.repaint(self._acting())
                self._show_legend()
            self._panel.show(self._scene_state.scene.layers, self._scene_state.exaggeration)

    def mark(self, elements: Collection[str]) -> None:
        """Mark some elements of the description by a colour of their own and their frames, in place of earlier ones.

        Args:
            elements: "world", "bodies/arm", "bodies/arm/joint", "bodies/arm/frames/tip", "closures/loop",
                "connections/spring", "nonholonomic/wheel"; what is not drawn is passed over.
        """
        with self._painting:
            self._scene_state.scene.mark(elements)

    def drag(self, frame: str | None, on_move: Callable[[], None] | None = None) -> None:
        """Show a handle at a frame: whoever drags it moves the mechanism by inverse kinematics, as near as it gets.

        Args:
            frame: Name of the frame; None for no handle.
            on_move: Called, in a thread of the server, when that has moved the mechanism.

        Raises:
            UnknownNameError: There is no such frame.
        """
        with self._painting:
            if self._handle is not None:
                self._handle.remove()
                self._handle = None
            if frame is not None:
                size = self._scene_state.scene.drawing.size
                self._handle = FrameHandle(self._server, self.mechanism, frame, self.state, size, self._dragged)
            self._on_drag = on_move

    def _dragged(self, is_over: bool) -> None:
        """Move the mechanism after its handle, or put the handle where the mechanism got."""
        with self._painting:
            if self._handle is None:
                return
            if is_over:
                self._handle.follow(self.state)
            else:
                self._stand(self._handle.reached(self.state))
            tell = self._on_drag
        if tell is not None:
            tell()

    def _keep_handle(self) -> None:
        """Put the handle onto the same frame of another mechanism, where it has one."""
        frame = None if self._handle is None else self._handle.frame
        self.drag(frame if frame in self.mechanism.model.names.frames else None, self._on_drag)

    def follow(self, body: str | None) -> None:
        """Let the cameras of all pages go along with a body, whose name is in the description; None: with none.

        Raises:
            UnknownNameError: There is no such body.
        """
        with self._painting:
            links = {link.name: i for i, link in enumerate(self.mechanism.tree.links)}
            if body is not None and body not in links:
                rule, remedy = "a body of the mechanism", did_you_mean(body, links)
                raise UnknownNameError(f"view: no body '{body}' to follow", f"'{body}'", rule, remedy)
            place = self._scene_state.posture.p
            self._camera_follow = (
                None if body is None else CameraFollow(self._server, body, links[body], place[links[body]])
            )
            self._panel.show_followed(body)

    def set_exaggeration(self, factor: float) -> None:
        """Multiply elastic coordinates in the picture."""
        with self._painting:
            self._scene_state.exaggeration = finite("exaggeration", factor)
            self._paint(self._scene_state.state)
            self._move_ghosts()
            self._panel.show(self._scene_state.scene.layers, self._scene_state.exaggeration)

    def set_dark(self, dark: bool) -> None:
        """Show page and picture in dark colours, or in light ones."""
        with self._painting:
            if dark and self._light is None:
                self._light = self._server.scene.add_light_ambient("/ambient", intensity=_DARK_LIGHT)
            elif not dark and self._light is not None:
                self._light.remove()
                self._light = None
            self._dark = dark
            self._panel.set_dark(dark)

    def slide(self, index: int, value: float) -> None:
        """Move one degree of freedom, by the index of its speed; loops close around it where they can."""
        self._slide({index: value})

    def move(self, values: Mapping[str, float], par: Mapping[str, float] | None = None) -> str:
        """Move some degrees of freedom, and change some run-time parameters; loops close around them where they can.

        Args:
            values: Values by the labels of `sliders` [rad or m].
            par: Parameters by name; those that are not named stay as they are.

        Returns:
            Why the loops can't be closed there, and the picture stays: "" where they can.

        Raises:
            UnknownNameError: There is no such slider or parameter.
        """
        with self._painting:
            return self._slide(*self._scene_state.by_name(values, par or {}))

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Sliders of the mechanism: one per speed."""
        return self._scene_state.sliders

    @property
    def values(self) -> Array:
        """Values of the sliders (nv)."""
        return self._scene_state.values

    def reset(self) -> None:
        """Show the configuration that was shown first."""
        with self._painting:
            self._stand(self._scene_state.first)

    # How it is painted; who calls these holds the lock.

    def _slide(self, changes: Mapping[int, float], par: Array | None = None) -> str:
        with self._painting:
            state, why = self._scene_state.with_sliders_moved(changes, par)
            self._stand(self._scene_state.state if why else state)
            self._panel.say("The loops can't be closed there." if why else "")
            return why

    def _is_playing(self) -> bool:
        return self._player is not None and self._player.playing

    def _live(self, state: State, t: float) -> None:
        """Show a state of something that goes on elsewhere, and its time [s]."""
        model, (q, u, par) = self.mechanism.model, state
        if (q.size, u.size, par.size) != (model.nq, model.nu, model.npar):
            return  # It was pushed before the mechanism changed.
        self._pause()
        self._paint(state)
        if time.monotonic() - self._followed > _FOLLOWED:
            self._panel.say(f"t = {t:.2f} s")
            self._follow()

    def _paint_motion(self) -> None:
        if self._player is not None:
            motion = self._player.motion
            self._paint(State(*motion.at(self._player.time)), self._acting())
            self._move_ghosts()
            if time.monotonic() - self._followed > _FOLLOWED or not self._player.playing:
                self._follow()

    def _show_ghosts(self, ghosts: tuple[Ghost, ...]) -> None:
        """Show these ghosts in place of those before."""
        if self._ghost_scene is not None:
            self._ghost_scene.remove()
        drawn = [(ghost.color, ghost.drawing) for ghost in ghosts]
        self._ghosts, self._ghost_scene = ghosts, GhostScene(self._server, drawn, self.layers) if ghosts else None

    def _move_ghosts(self) -> None:
        if self._ghost_scene is not None and self._player is not None:
            t = np.array([self._player.time])
            self._ghost_scene.move(
                [
                    ghost.posture(self.mechanism, t, self.exaggeration)[0] if ghost.is_shown(t)[0] else None
                    for ghost in self._ghosts
                ]
            )

    def _stand(self, state: State, acting: Acting | None = None) -> None:
        self._pause()
        self._paint(state, acting)
        self._follow()

    def _pause(self) -> None:
        if self._player is not None:
            self._player.playing = False

    def _paint(self, state: State, acting: Acting | None = None) -> None:
        self.painted += self._scene_state.paint(state, acting)
        if self._camera_follow is not None:
            place = self._scene_state.posture.p[self._camera_follow.link]
            self._camera_follow.move(place, self._scene_state.scene.drawing.size)
        if self._handle is not None:
            self._handle.follow(self._scene_state.state)

    def _acting(self) -> Acting | None:
        """Forces of the run that plays and its time, where they are shown; formed when they are first asked for."""
        player, scene_state = self._player, self._scene_state
        if player is None or player.run is None or scene_state.scene.layers.isdisjoint(ARROWS):
            return None
        if self._forces is None:
            try:
                self._forces = RunForces(player.run, self.mechanism.tree, scene_state.scene.drawing)
            except SymofrosError as error:
                self._panel.say(f"No forces: {error.problem.what}")
                return None
        return self._forces, player.time

    def _show_legend(self) -> None:
        layers = self._scene_state.scene.layers
        if self._forces is not None:
            self._panel.legend(self._forces.legend(layers))
        else:
            self._panel.legend([] if layers.isdisjoint(ARROWS) else ["Forces are those of a trajectory that plays."])

    def _follow(self) -> None:
        self._panel.follow(self._scene_state.values, self._player)
        self._judge_bending()
        self._followed = time.monotonic()

    def _judge_bending(self) -> None:
        """Judge the state, not its exaggerated picture; remark on beams that it bends beyond a per cent of error."""
        self.bendings = self.mechanism.bendings(self._scene_state.state)
        self._panel.warn(bending_notes(self.bendings))

    def _show_scale(self, height: float | None) -> None:
        """Show how large the picture is at the depth of what its camera looks at [m]; None: pages differ."""
        with self._painting:
            self._height = height
            self._panel.scale(height)

    def _new_panel(self) -> Panel:
        scene_state, mechanism = self._scene_state, self._scene_state.mechanism
        panel = Panel(
            self._server,
            self,
            scene_state.scene.drawing,
            scene_state.scene.layers,
            self.sliders,
            scene_state.exaggeration if mechanism.is_flexible else None,
            self._player,
            self._controls,
            self._dark,
            self._ghosts,
            self._signals,
            tuple(dict.fromkeys(link.name for link in mechanism.tree.links)),
        )
        panel.show_followed(None if self._camera_follow is None else self._camera_follow.body)
        panel.follow(scene_state.values, self._player)
        panel.legend([] if self._forces is None else self._forces.legend(scene_state.scene.layers))
        panel.scale(self._height)
        return panel
