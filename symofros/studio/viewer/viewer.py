"""Viewer: a mechanism in the browser, shown, played or followed live."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any, NamedTuple, Self

from symofros.description import System
from symofros.runtime.model import ArrayLike
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.drawing.poses import Mechanism, State
from symofros.studio.viewer.drawing.tracks import tracks_of
from symofros.studio.viewer.page.cameras import CameraWatch
from symofros.studio.viewer.page.scene_state import Acting
from symofros.studio.viewer.page.viewer_page import ViewerPage
from symofros.studio.viewer.page.viser_server import LOOPBACK, PORT, start_server, stop_server
from symofros.studio.viewer.playing.ghosts import ghosts_of
from symofros.studio.viewer.playing.motion import Played, finite, motion_of, positive
from symofros.studio.viewer.playing.player import Player
from symofros.studio.viewer.playing.signals import coordinate_units, signals_of

_READY = 60.0  # Seconds that a page's first word waits for the picture.
RATE = 60.0  # Pictures a second at most; browsers show no more.


class _Wanted(NamedTuple):
    """A state to be shown, and its time [s]."""

    state: State
    t: float


class Viewer(ViewerPage):
    """A web page with a mechanism in it, for any number of browsers.

    The page is served from this process until `close()`, or the end of a `with`. Methods may be called from any thread.

    Args:
        system: System to show.
        host: Address that it is served at; the default is seen from this machine only. Whoever has `url`, which has a
            token, sees the model, and may move its controls; other addresses, hosts and pages are refused.
        port: Port of the page; 0 for any free one.
        exaggeration: Factor of the elastic coordinates in the picture.
        rate: Pictures a second at most.
        controls: Whether the page has sliders and buttons; not, for a page that is embedded in another.
        paths: Curves drawn beside it, each (name, points) or (name, points, color): points (n, 3) in the world, or
            (n, 2) in its plane z = 0 [m]; red, green and blue, 0 to 255.
        on_pick: Called, in a thread of the server, with the element that somebody clicks in the picture: "bodies/arm",
            "bodies/arm/joint", "bodies/arm/frames/tip", "closures/loop". Nothing can be clicked without it.
        on_zoom: Called, in a thread of the server, when it changes how high the picture is at the depth of what its
            camera looks at [m]; None while more than one browser looks, or none.

    Attributes:
        painted: Number of pictures shown.
        dropped: Number of pushed states that were dropped for newer ones.

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
        on_pick: Callable[[str], None] | None = None,
        on_zoom: Callable[[float | None], None] | None = None,
    ) -> None:
        self._period = 1.0 / positive("rate", rate)
        exaggeration = finite("exaggeration", exaggeration)
        mechanism = Mechanism(system, tracks_of(paths))
        self._token = secrets.token_urlsafe(16)
        self._ready = threading.Event()
        title, take = f"{system.name} - SYMOFROS", self._take_colours if controls else None
        server = start_server(host, port, self._token, title, take, panel=controls)
        self._wake = threading.Condition()  # Guards what is wanted; held for moments only, never while painting.
        self._wanted: _Wanted | None = None
        self._closing = False
        self.dropped = 0
        try:
            super().__init__(server, mechanism, exaggeration, controls, on_pick)
            self._on_zoom = on_zoom
            self._camera = CameraWatch(server, self._zoomed)
        except BaseException:
            stop_server(server)
            raise
        self._worker = threading.Thread(target=self._work, name="symofros view", daemon=True)
        self._worker.start()
        self._ready.set()

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
        """Address to open in a browser or an iframe; whoever has it may look and move controls, nobody else."""
        return f"http://{f'[{self.host}]' if ':' in self.host else self.host}:{self.port}/{self._token}/"

    @property
    def clients(self) -> int:
        """Number of browsers connected to the viewer."""
        return len(self._server.get_clients())

    @property
    def is_closed(self) -> bool:
        """Whether the viewer has been closed."""
        return self._closing

    @property
    def picture_height(self) -> float | None:
        """Height of the picture at the depth of what its camera looks at [m]; None unless one browser looks."""
        return self._camera.height

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
            self._player = self._forces = None
            self._show_ghosts(())
            self._camera_follow = None
            self._scene_state.change(mechanism)
            self._keep_handle()
            self._panel = self._new_panel()
            self._judge_bending()

    def show(
        self,
        q: ArrayLike | None = None,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        acting: Acting | None = None,
    ) -> None:
        """Show a configuration, now; a motion that plays is paused.

        Args:
            q: Coordinates (nq); the neutral ones by default.
            u: Inputs (nu), for prescribed motions.
            par: Run-time parameters (npar); the mechanism is drawn anew where they change it.
            acting: Forces of the run that it is a state of, and its time [s], for the layers "forces" and "moments".

        Raises:
            ShapeError: An array does not fit the model.
        """
        state = self.mechanism.state(q, u, par)
        with self._painting:
            self._discard()
            self._stand(state, acting)

    def push(self, t: float, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> None:
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

    def play(
        self,
        run: Played,
        *,
        speed: float = 1.0,
        loop: bool = True,
        ghosts: Mapping[str, Played] | None = None,
        signals: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        """Show a motion from its beginning, with controls to pause, to go to a time, and to change the speed.

        Args:
            run: A trajectory of this system, or times (n) and coordinates (n, nq).
            speed: Seconds of the motion a second: 0.1 is ten times slower than it happens.
            loop: Whether it begins again at its end.
            ghosts: Other runs by names for the legend, transparent beside it, at the same times; each is shown from its
                first time to its last.
            signals: More to plot by name beside coordinates, inputs and energies: a value, or several, at each time
                of the motion (n) or (n, k).

        Raises:
            ShapeError: The motion, a ghost or a signal does not fit the model.
            SymofrosError: The speed is not a number above 0, or ghosts are too many or change their shapes.
        """
        motion = motion_of(self.mechanism.model, run)
        shown = ghosts_of(self.mechanism, ghosts or {}, self.mechanism.drawing(motion.par[0]))
        whole = run if isinstance(run, Trajectory) else None
        plotted = signals_of(motion, coordinate_units(self.mechanism.tree), whole, signals)
        player = Player(motion, speed, loop, whole)
        player.start()
        with self._painting:
            self._discard()
            self._player, self._forces = player, None
            self._show_ghosts(shown)
            self._signals = plotted
            self._panel = self._new_panel()
            self._judge_bending()
            self._paint_motion()
            self._show_legend()
        self._call_worker()

    def toggle(self) -> None:
        """Play or pause the motion."""
        super().toggle()
        self._call_worker()

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
        """The viewer itself."""
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
                    self._live(wanted.state, wanted.t)
                elif self._player is not None:
                    self._player.advance(began - last)
                    self._paint_motion()
            last = began
            time.sleep(max(0.0, self._period - (time.monotonic() - began)))

    def _call_worker(self) -> None:
        with self._wake:
            self._wake.notify()

    def _take_colours(self, dark: bool) -> None:
        """Show the colours of who opens the page first; a page may be opened before all is there."""
        if self._ready.wait(_READY) and not self._closing:
            self.set_dark(dark)

    def _zoomed(self, height: float | None) -> None:
        if self._closing:
            return
        self._show_scale(height)
        if self._on_zoom is not None:
            self._on_zoom(height)

    def _discard(self) -> None:
        with self._wake:
            self._wanted = None
