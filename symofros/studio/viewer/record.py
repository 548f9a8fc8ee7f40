"""Recordings: a motion as a web page that plays by itself, as a film, or as a moving picture; a posture as a picture.

Films and pictures are drawn by `raster`, so nothing opens a browser.
"""

from __future__ import annotations

import io
import secrets
import tempfile
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.stored import write_atomically
from symofros.description import System
from symofros.diagrams.result import DiagramRun
from symofros.errors import SymofrosError, did_you_mean
from symofros.runtime.model import ArrayLike
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.drawing.drawing import Drawing
from symofros.studio.viewer.drawing.layers import ARROWS, Arrows, check_layer, initial_layers
from symofros.studio.viewer.drawing.poses import Mechanism, Posture
from symofros.studio.viewer.drawing.tracks import tracks_of
from symofros.studio.viewer.page.ghost_scene import GhostScene, legend_of
from symofros.studio.viewer.page.viser_scene import ViserScene
from symofros.studio.viewer.page.viser_server import LOOPBACK, start_server, stop_server
from symofros.studio.viewer.playing.diagram_motion import played, shown_system_and_states
from symofros.studio.viewer.playing.ghosts import ghosts_of
from symofros.studio.viewer.playing.motion import Played, PlayedMotion, finite, motion_of, positive
from symofros.studio.viewer.playing.run_forces import RunForces
from symofros.studio.viewer.playing.signals import Signal, coordinate_units, signals_of
from symofros.studio.viewer.render.camera import Camera, picture_height, scale_bar
from symofros.studio.viewer.render.raster import Image, picture
from symofros.studio.viewer.replays.reduced import reducing, tolerance_of
from symofros.studio.viewer.replays.replay import lighter, replay_page

MAX_FRAMES = 20_000  # Eleven minutes at thirty a second.
_INK = (60, 60, 60)
_POSE_STEP = 2.0**-17  # Of the mechanism's size: the step of positions in pages.
_SUFFIXES = (".html", ".mp4", ".gif", ".png")


class _Recording:
    """A motion at the times of its pictures."""

    def __init__(
        self,
        mechanism: Mechanism,
        motion: PlayedMotion,
        period: float,
        speed: float,
        exaggeration: float,
        show: frozenset[str] = frozenset(),
        run: Trajectory | None = None,
        ghosts: Mapping[str, Played] | None = None,
    ) -> None:
        self.period = period
        count = int(np.ceil((motion.end - motion.start) / (speed * period) - 1e-9)) + 1
        if count > MAX_FRAMES:
            raise SymofrosError(
                "record: too long",
                f"{count} pictures",
                f"{MAX_FRAMES} at most",
                "raise the speed, or lower the pictures a second",
            )
        self.t = np.minimum(motion.start + speed * period * np.arange(count), motion.end)
        q, u, par = motion.at(self.t)
        # Events set parameters seldom: a drawing lasts from one picture whose parameters are others to the next.
        first = [0, *(np.flatnonzero(np.any(par[1:] != par[:-1], axis=1)) + 1)]
        self._drawings = {int(i): mechanism.drawing(par[i]) for i in first}
        self.drawing = self._drawings[0]
        self.camera = Camera.of(max(self._drawings.values(), key=lambda drawing: drawing.size))
        self.q = q
        self.postures = mechanism.posture(q, u, par if len(first) > 1 else par[0], exaggeration)
        self.layers = initial_layers(self.drawing) | show
        acting = run is not None and not self.layers.isdisjoint(ARROWS)
        self._forces = RunForces(run, mechanism.tree, self.drawing) if run is not None and acting else None
        self.count, self.exaggeration, self.speed = count, exaggeration, speed
        self.ghosts = ghosts_of(mechanism, ghosts or {}, self.drawing)
        self._ghost_postures = [
            (ghost.is_shown(self.t), ghost.posture(mechanism, self.t, exaggeration)) for ghost in self.ghosts
        ]

    def __iter__(self) -> Iterator[tuple[Drawing, Posture, Arrows]]:
        drawing = self.drawing
        for i in range(self.count):
            drawing = self._drawings.get(i, drawing)
            posture, forces = self.postures[i], self._forces
            arrows = {} if forces is None else forces.arrows(float(self.t[i]), posture, self.layers)
            yield drawing, posture, arrows

    def ghost_postures(self, index: int) -> list[Posture | None]:
        """Postures of the ghosts in a picture; None of those that have no state then."""
        return [postures[index] if is_shown[index] else None for is_shown, postures in self._ghost_postures]

    def pictures(self, size: tuple[int, int]) -> Iterator[Image]:
        return (picture(drawing, posture, self.layers, self.camera, *size, arrows) for drawing, posture, arrows in self)

    def captions(self) -> Iterator[str]:
        """Time of each picture, and how much larger deformations are drawn than they are."""
        return ("\n".join([*self.legend, f"t = {t:.3f} s{self.factor}"]) for t in self.t)

    @property
    def factor(self) -> str:
        """Exaggeration of deformations, in words after the time; "" where there is none."""
        return "" if self.exaggeration == 1.0 else f", deformation × {self.exaggeration:g}"

    @property
    def legend(self) -> list[str]:
        """Scales of the arrows, in words."""
        return [] if self._forces is None else self._forces.legend(self.layers)


@checked
def record(
    system: System | DiagramRun,
    run: Played | str | Path,
    path: str | Path | None = None,
    *,
    block: str = "",
    exaggeration: float = 1.0,
    speed: float = 1.0,
    paths: Sequence[Sequence[Any]] = (),
    rate: float = 30.0,
    size: tuple[int, int] = (960, 720),
    caption: bool = False,
    show: Collection[str] = (),
    ghosts: Mapping[str, Played | DiagramRun] | None = None,
    signals: Mapping[str, ArrayLike] | None = None,
    simulate: bool | Mapping[str, Any] = False,
) -> Path:
    """Write a motion as a file that others can look at without SYMOFROS.

    `sf.record(system, run, "run.html")`, or `sf.record(run, "run.html")` of a diagram's run.

    Args:
        system: System that moves, or a diagram's run.
        run: A trajectory of it, or times (n) and coordinates (n, nq); left out where a diagram's run is stated.
        path: .html (a page with the scene in it, to turn and to play; needs viser, and no network), .mp4 (needs ffmpeg,
            as the extra `video` brings it), .gif, or .png (the last state).
        block: Block of a diagram's run: the block whose mechanism is shown; where there is one only, that.
        exaggeration: Factor of the elastic coordinates.
        speed: Seconds of the motion a second.
        paths: Curves drawn beside it, as of `Viewer`.
        rate: Pictures a second; those of a GIF last whole hundredths of a second.
        size: Width and height of films and pictures, even numbers.
        caption: Whether time, exaggeration and a scale bar are on films and pictures (Pillow, of the extra `view`).
        show: Layers that are shown beside those that a `Viewer` begins with (`Viewer.set_layer`): "forces", "moments",
            "frames" (in pages), "inertias" and others.
        ghosts: Other runs of the mechanism by names for the legend, transparent beside the motion, at the same times;
            in pages (.html).
        signals: More that pages plot over time beside coordinates, inputs and energies, by name: a value, or several,
            at each time of the run (n) or (n, k).
        simulate: Whether the page simulates, too, on from any instant of the replay, with states, inputs and parameters
            that its reader may change (needs a trajectory, and the extra `zig`); or how: `method`, `dt`, `rtol`,
            `atol`, `beam_limit` as of `sf.export`. By default the method of the run and steps of a millisecond; inputs
            stay what they were at that instant.

    Returns:
        The path; the file is there whole or not at all.

    Raises:
        SymofrosError: Another suffix, too long a motion, a size or a rate that can't be, an extra that is missing, or
            a motion that can't be simulated on.
        CompileError: `simulate` without the package ziglang.
        ShapeError: The motion does not fit the system, or a path can't be drawn.
        UnknownNameError: The diagram's run has no such mechanism, or several; or there is no such layer.
    """
    system, run, file = _asked(system, run, path, block)
    check_suffix(file)
    speed, rate, exaggeration = positive("speed", speed), positive("rate", rate), finite("exaggeration", exaggeration)
    if any(side < 2 or side % 2 or side > 4096 for side in size):
        raise SymofrosError(
            "record: no such size", str(size), "even numbers of pixels, 2 to 4096", "such as (960, 720)"
        )
    if not isinstance(simulate, bool | Mapping):
        found, rule = f"{simulate!r:.40}", "True, False, or how: method, dt, rtol, atol, beam_limit"
        raise SymofrosError("record: simulate says neither whether nor how", found, rule, "simulate=True")
    asked = simulate is not False
    if asked and file.suffix != ".html":
        raise SymofrosError(
            "record: only pages simulate", f"'{file.name}'", "simulate is for .html", "leave simulate out"
        )
    if ghosts and file.suffix != ".html":
        raise SymofrosError(
            "record: only pages show ghosts", f"'{file.name}'", "ghosts are for .html", "leave ghosts out"
        )
    mechanism = Mechanism(system, tracks_of(paths))
    motion = motion_of(mechanism.model, run)
    if file.suffix == ".png":
        motion = PlayedMotion(motion.model, motion.t[-1:], motion.q[-1:], motion.u[-1:], motion.par[-1:])
    plotted = signals_of(
        motion, coordinate_units(mechanism.tree), run if isinstance(run, Trajectory) else None, signals
    )
    period = max(round(100.0 / rate), 1) / 100.0 if file.suffix == ".gif" else 1.0 / rate
    whole = run if isinstance(run, Trajectory) else None
    others = played(ghosts, block)
    frames = _Recording(mechanism, motion, period, speed, exaggeration, _layers(show, whole), whole, others)
    pictures = _captioned(frames, size) if caption else frames.pictures(size)
    write: dict[str, Callable[[], bytes]] = {
        ".html": lambda: _page(frames, mechanism, plotted, _onward(system, run, frames, simulate) if asked else None),
        ".mp4": lambda: _film(pictures, frames.period, size),
        ".gif": lambda: _gif(pictures, frames.period),
        ".png": lambda: _png(pictures),
    }
    write_atomically(file, write[file.suffix]())
    return file


def _layers(show: Collection[str], run: Trajectory | None) -> frozenset[str]:
    """The layers that are asked for."""
    for layer in show:
        check_layer("record", layer)
        if layer in ARROWS and run is None:
            rule = "forces are those of a trajectory, with its speeds and inputs"
            raise SymofrosError(f"record: no {layer}", "coordinates over time", rule, "give the trajectory")
    return frozenset(show)


def check_suffix(file: Path) -> None:
    """Refuse a file whose suffix is no format of recordings.

    Raises:
        SymofrosError: Its suffix is another.
    """
    if file.suffix not in _SUFFIXES:
        raise SymofrosError(
            f"record: can't write '{file.name}'",
            file.suffix or "no suffix",
            f"one of {', '.join(_SUFFIXES)}",
            did_you_mean(file.suffix, _SUFFIXES),
        )


def _asked(
    system: System | DiagramRun, run: Played | str | Path, path: str | Path | None, block: str
) -> tuple[System, Played, Path]:
    """System, motion and path of a recording, from the arguments of `record`."""
    if isinstance(system, DiagramRun) and isinstance(run, (str, Path)) and path is None:
        return *shown_system_and_states(system, block), Path(run)
    if isinstance(system, DiagramRun) or isinstance(run, (str, Path)) or path is None:
        raise SymofrosError(
            "record: what is to be written?",
            "other arguments",
            "a system, its motion and a path; or a diagram's run and a path",
            'for example sf.record(system, run, "run.html")',
        )
    return system, run, Path(path)


def _onward(system: System, run: Played, frames: _Recording, simulate: bool | Mapping[str, Any]) -> Mapping[str, Any]:
    from symofros.studio.viewer.replays.onward import onward  # With exports, which other recordings need not import.

    return onward(system, run, frames.t, frames.q, {} if isinstance(simulate, bool) else simulate)


def _page(
    frames: _Recording, mechanism: Mechanism, signals: Sequence[Signal], simulated: Mapping[str, Any] | None
) -> bytes:
    model, units = mechanism.model, coordinate_units(mechanism.tree)
    pace = "" if frames.speed == 1.0 else f", at {frames.speed:g} × its speed"
    tolerance = tolerance_of(frames.drawing)
    reduced = reducing(frames.layers, tolerance)
    server = start_server(LOOPBACK, 0, secrets.token_urlsafe(16))
    try:
        shown = frames.drawing
        scene = ViserScene(server, reduced(shown), frames.postures[0], frames.layers)
        beside = GhostScene(server, [(ghost.color, reduced(ghost.drawing)) for ghost in frames.ghosts], frames.layers)
        serializer = server.get_scene_serializer()
        for i, (drawing, posture, arrows) in enumerate(frames):
            if drawing is not shown:
                shown = drawing
                scene = ViserScene(server, reduced(shown), posture, frames.layers)
            scene.move(posture, arrows)
            beside.move(frames.ghost_postures(i))
            serializer.insert_sleep(frames.period)
        return replay_page(
            lighter(serializer.as_html(), frames.drawing.size * _POSE_STEP),
            f"{mechanism.system.name} - SYMOFROS",
            frames.camera,
            frames.t,
            frames.period,
            "; ".join([frames.factor + pace, *frames.legend]),
            frames.q,
            model.names.q,
            [units.get(name, "") for name in model.names.q],
            signals,
            simulated,
            legend_of(frames.ghosts) if frames.ghosts else "",
            tolerance if any(part.kind == "visuals" for part in frames.drawing.parts) else 0.0,
        ).encode()
    finally:
        stop_server(server)


def _captioned(frames: _Recording, size: tuple[int, int]) -> Iterator[Image]:
    """Pictures with their captions at the lower left, and a scale bar at the lower right."""
    images = _extra("PIL.Image", "captions need Pillow", "symofros[view]")
    pencil = _extra("PIL.ImageDraw", "captions need Pillow", "symofros[view]")
    height = max(10, size[1] // 30)
    camera = frames.camera
    bar = scale_bar(picture_height(camera.position, camera.target, camera.fov))
    for image, text in zip(frames.pictures(size), frames.captions(), strict=True):
        drawn = images.fromarray(image)
        pen = pencil.Draw(drawn)
        lines = text.count("\n") + 1
        pen.text((height, size[1] - height - 1.3 * lines * height), text, fill=_INK, font_size=height)
        right, foot = size[0] - height, size[1] - height
        left = right - round(bar.share * size[1])
        pen.line([(left, foot - height // 3), (left, foot), (right, foot), (right, foot - height // 3)], fill=_INK)
        pen.text(((left + right) / 2, foot - height // 3), bar.text, fill=_INK, font_size=height, anchor="ms")
        yield np.asarray(drawn)


def _film(pictures: Iterator[Image], period: float, size: tuple[int, int]) -> bytes:
    ffmpeg = _extra("imageio_ffmpeg", "MP4 needs ffmpeg", "symofros[video]")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "film.mp4"
        # H.264 in 4:2:0 is what every browser and player shows; macro blocks of 2 keep the size as it is.
        writer = ffmpeg.write_frames(
            str(target),
            size,
            fps=1.0 / period,
            codec="libx264",
            quality=7,
            pix_fmt_out="yuv420p",
            macro_block_size=2,
        )
        writer.send(None)
        for image in pictures:
            writer.send(np.ascontiguousarray(image))
        writer.close()
        return target.read_bytes()


def _gif(pictures: Iterator[Image], period: float) -> bytes:
    images = _extra("PIL.Image", "GIF needs Pillow", "symofros[view]")
    # A palette of its own for each picture flickers; that of the first serves all, as the pieces are the same.
    first, *others = (images.fromarray(image) for image in pictures)
    palette = first.quantize(255)
    paletted = [one.quantize(palette=palette, dither=images.Dither.NONE) for one in others]
    stream = io.BytesIO()
    palette.save(stream, "GIF", save_all=True, append_images=paletted, duration=round(1000 * period), loop=0)
    return stream.getvalue()


def _png(pictures: Iterator[Image]) -> bytes:
    images = _extra("PIL.Image", "PNG needs Pillow", "symofros[view]")
    stream = io.BytesIO()
    images.fromarray(next(pictures)).save(stream, "PNG", optimize=True)
    return stream.getvalue()


def _extra(module: str, why: str, install: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        raise SymofrosError(
            f"record: {why}", f"no module {module}", "recording is an extra", f"pip install '{install}'"
        ) from None
