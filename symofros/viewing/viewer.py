"""Viewer: a mechanism in the browser, shown, played or followed live."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any, NamedTuple, Self

from symofros.description.system import System
from symofros.runtime.model import Given
from symofros.viewing.motion import Played, finite, motion_of, positive
from symofros.viewing.panel import Panel
from symofros.viewing.player import Player
from symofros.viewing.poses import Mechanism, State
from symofros.viewing.server import LOOPBACK, PORT, start_server, stop_server
from symofros.viewing.shapes import Array
from symofros.viewing.sliders import Slider
from symofros.viewing.stage import Stage
from symofros.viewing.tracks import tracks_of

RATE = 60.0  # Pictures a second at most; browsers show no more.
_FOLLOWED = 0.1  # Seconds between updates of the controls: they cost more than the picture.


class _Wanted(NamedTuple):
    """A state to be shown, and its time [s]."""

    state: State
    t: float


class Viewer:
    """A web page with a mechanism in it, for any number of browsers.

    The page is served from this process until `close()`, or the end of a `with`. Methods may be called from any thread.

    Args:
        system: What to show.
        host: Address that it is served at; the default is seen from this machine only. Nothing asks for a password:
            whoever reaches the address sees the model, and may move its controls.
        port: Of the page; 0 for any free one.
        exaggeration: What multiplies elastic coordinates in the picture.
        rate: Pictures a second at most.
        controls: Whether the page has sliders and buttons; not, for a page that is embedded in another.
        paths: Curves drawn beside it, each (name, points) or (name, points, color): points (n, 3) in the world, or
            (n, 2) in its plane z = 0 [m]; red, green and blue, 0 to 255.

    Attributes:
        painted: How many pictures were shown.
        dropped: How many pushed states were not, because newer ones came first.

    Raises:
        DescriptionError: The system can't be a mechanism.
        ShapeError: A path can't be drawn.
        SymofrosError: viser is not installed (the extra `view`), or the address can't be served at.
    """

    def __init__(
        self,
        system: System,
        *,
        host: str = LOOPBACK,
        port: int = PORT,
        exaggeration: float = 1.0,
        rate: float = RATE,
        controls: bool = True,
        paths: Sequence[Sequence[Any]] = (),
    ) -> None:
        self._period, self._controls = 1.0 / positive("rate", rate), controls
        exaggeration = finite("exaggeration", exaggeration)
        mechanism = Mechanism(system, tracks_of(paths))
        self._server = start_server(host, port)
        self._wake = threading.Condition()  # Guards what is wanted; held for moments only, never while painting.
        self._painting = threading.RLock()  # Guards the picture, the player and the controls.
        self._wanted: _Wanted | None = None
        self._closing = False
        self._player: Player | None = None
        self._followed = -_FOLLOWED
        self.painted = self.dropped = 0
        try:
            self._stage = Stage(self._server, mechanism, exaggeration)
            self._panel = self._new_panel()
        except BaseException:
            stop_server(self._server)
            raise
        self._worker = threading.Thread(target=self._work, name="symofros view", daemon=True)
        self._worker.start()

    # Where it is.

    @property
    def host(self) -> str:
        """The address it is served at."""
        return str(self._server.get_host())

    @property
    def port(self) -> int:
        """The port it is served at."""
        return int(self._server.get_port())

    @property
    def url(self) -> str:
        """What to open in a browser, or in an iframe."""
        return f"http://{f'[{self.host}]' if ':' in self.host else self.host}:{self.port}"

    @property
    def clients(self) -> int:
        """How many browsers look at it."""
        return len(self._server.get_clients())

    @property
    def is_closed(self) -> bool:
        """Whether it serves no more."""
        return self._closing

    @property
    def mechanism(self) -> Mechanism:
        """What is shown, as it is computed with."""
        return self._stage.mechanism

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self._stage.state

    # What is shown.

    def set_system(self, system: System) -> None:
        """Show another mechanism, or the same one changed.

        Browsers keep their cameras; where the coordinates are the same, they stay as they are, loops closed.

        Raises:
            DescriptionError: The system can't be a mechanism; the picture stays as it was.
        """
        mechanism = Mechanism(system, self.mechanism.tracks)
        with self._painting:
            self._discard()
            self._player = None
            self._stage.change(mechanism)
            self._panel = self._new_panel()

    def show(self, q: Given | None = None, *, u: Given | None = None, par: Given | None = None) -> None:
        """Show a configuration, now; a motion that plays is paused.

        Args:
            q: Coordinates (nq); the neutral ones by default.
            u: Inputs (nu), for prescribed motions.
            par: Run-time parameters (npar); the mechanism is drawn anew where they change it.

        Raises:
            ShapeError: An array does not fit the model.
        """
        state = self.mechanism.state(q, u, par)
        with self._painting:
            self._discard()
            self._stand(state)

    def push(self, t: float, q: Given, *, u: Given | None = None, par: Given | None = None) -> None:
        """Show a configuration soon, without waiting: for loops that have no time to lose.

        The newest state is what is shown: states that come faster than pictures are dropped. A state that is not finite
        leaves the picture as it is.

        Args:
            t: Time [s], shown beside the picture.
            q: Coordinates (nq); copied.
            u: Inputs (nu), for prescribed motions.
            par: Run-time parameters (npar).

        Raises:
            ShapeError: An array does not fit the model.
        """
        wanted = _Wanted(self.mechanism.state(q, u, par), float(t))
        with self._wake:
            self.dropped += self._wanted is not None
            self._wanted = wanted
            self._wake.notify()

    def play(self, run: Played, *, speed: float = 1.0, loop: bool = True) -> None:
        """Show a motion from its beginning, with controls to pause, to go to a time, and to change the speed.

        Args:
            run: A trajectory of this system, or times (n) and coordinates (n, nq).
            speed: Seconds of the motion a second: 0.1 is ten times slower than it happens.
            loop: Whether it begins again at its end.

        Raises:
            ShapeError: The motion does not fit the model.
            SymofrosError: The speed is not a number above 0.
        """
        player = Player(motion_of(self.mechanism.model, run), speed, loop)
        player.start()
        with self._painting:
            self._discard()
            self._player = player
            self._panel = self._new_panel()
            self._paint_motion()
        self._call_worker()

    @property
    def exaggeration(self) -> float:
        """What multiplies elastic coordinates in the picture."""
        return self._stage.exaggeration

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
        self._call_worker()

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

    def set_layer(self, layer: str, visible: bool) -> None:
        """Show or hide a layer.

        Args:
            layer: "bodies", "inertias", "joints", "constraints", "paths", "visuals", "frames", "labels" or "ground".
            visible: Whether it is to be seen.

        Raises:
            UnknownNameError: There is no such layer.
        """
        with self._painting:
            self._stage.scene.show(layer, visible)
            self._panel.show(self._stage.scene.layers, self._stage.exaggeration)

    def set_exaggeration(self, factor: float) -> None:
        """Multiply elastic coordinates in the picture."""
        with self._painting:
            self._stage.exaggeration = finite("exaggeration", factor)
            self._paint(self._stage.state)
            self._panel.show(self._stage.scene.layers, self._stage.exaggeration)

    def slide(self, index: int, value: float) -> None:
        """Move one degree of freedom, by the index of its speed; loops close around it where they can."""
        self._slide({index: value})

    def move(self, values: Mapping[str, float], par: Mapping[str, float] | None = None) -> str:
        """Move some degrees of freedom, and change some run-time parameters; loops close around them where they can.

        Args:
            values: By the labels of `sliders` [rad or m].
            par: By the names of the parameters; those that are not named stay as they are.

        Returns:
            Why the loops can't be closed there, and the picture stays: "" where they can.

        Raises:
            UnknownNameError: There is no such slider or parameter.
        """
        with self._painting:
            return self._slide(*self._stage.by_name(values, par or {}))

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """What moves it: one slider a speed."""
        return self._stage.sliders

    @property
    def values(self) -> Array:
        """Where the sliders stand (nv)."""
        return self._stage.values

    def reset(self) -> None:
        """Show the configuration that was shown first."""
        with self._painting:
            self._stand(self._stage.first)

    # Its end.

    def wait(self) -> None:
        """Wait until it is closed, or the user interrupts."""
        with suppress(KeyboardInterrupt):
            while self._worker.is_alive():
                self._worker.join(0.5)

    def close(self) -> None:
        """Stop serving; browsers keep the last picture."""
        with self._wake:
            if self._closing:
                return
            self._closing = True
            self._wake.notify()
        self._worker.join()
        stop_server(self._server)

    def __enter__(self) -> Self:
        """The viewer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    # How it works: a thread of its own paints what was pushed or is played; all else is painted by who asks for it.

    def _work(self) -> None:
        last = time.monotonic()
        while True:
            with self._wake:
                while not (self._closing or self._wanted or self._is_playing()):
                    self._wake.wait()
                    last = time.monotonic()
                if self._closing:
                    return
            began = time.monotonic()
            with self._painting:
                # Taken only now: what is shown meanwhile by another thread is newer than what waited.
                with self._wake:
                    wanted, self._wanted = self._wanted, None
                if wanted is not None:
                    self._live(wanted)
                elif self._player is not None:
                    self._player.advance(began - last)
                    self._paint_motion()
            last = began
            time.sleep(max(0.0, self._period - (time.monotonic() - began)))

    def _slide(self, changes: Mapping[int, float], par: Array | None = None) -> str:
        with self._painting:
            state, why = self._stage.slid(changes, par)
            self._stand(self._stage.state if why else state)
            self._panel.say("The loops can't be closed there." if why else "")
            return why

    def _is_playing(self) -> bool:
        return self._player is not None and self._player.playing

    def _call_worker(self) -> None:
        with self._wake:
            self._wake.notify()

    def _discard(self) -> None:
        with self._wake:
            self._wanted = None

    def _live(self, wanted: _Wanted) -> None:
        model, (q, u, par) = self.mechanism.model, wanted.state
        if (q.size, u.size, par.size) != (model.nq, model.nu, model.npar):
            return  # It was pushed before the mechanism changed.
        self._pause()
        self._paint(wanted.state)
        if time.monotonic() - self._followed > _FOLLOWED:
            self._panel.say(f"t = {wanted.t:.2f} s")
            self._follow()

    def _paint_motion(self) -> None:
        if self._player is not None:
            motion = self._player.motion
            q, u = motion.at(self._player.time)
            self._paint(State(q, u, motion.par))
            if time.monotonic() - self._followed > _FOLLOWED or not self._player.playing:
                self._follow()

    def _stand(self, state: State) -> None:
        self._pause()
        self._paint(state)
        self._follow()

    def _pause(self) -> None:
        if self._player is not None:
            self._player.playing = False

    def _paint(self, state: State) -> None:
        self.painted += self._stage.paint(state)

    def _follow(self) -> None:
        self._panel.follow(self._stage.values, self._player)
        self._followed = time.monotonic()

    def _new_panel(self) -> Panel:
        stage, mechanism = self._stage, self._stage.mechanism
        panel = Panel(self._server, self, stage.scene.drawing, stage.scene.layers,
                      self.sliders, stage.exaggeration if mechanism.is_flexible else None, self._player,
                      self._controls)  # fmt: skip
        panel.follow(stage.values, self._player)
        return panel
