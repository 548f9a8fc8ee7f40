"""The controls beside the picture: playing, what is shown, exaggeration, coordinates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Protocol

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.drawing import Drawing
from symofros.studio.viewer.drawing.layers import ARROWS, LAYERS
from symofros.studio.viewer.page.ghost_scene import legend_of
from symofros.studio.viewer.page.plots import ForcePlot, SignalPlot
from symofros.studio.viewer.playing.ghosts import Ghost
from symofros.studio.viewer.playing.player import Player
from symofros.studio.viewer.playing.signals import Signal
from symofros.studio.viewer.playing.sliders import Slider
from symofros.studio.viewer.render.camera import scale_bar

_SPEEDS = ("0.01", "0.1", "0.25", "0.5", "1", "2", "5")
_LAYER_NAMES = {
    "inertias": "inertia boxes",
    "constraints": "constraints and springs",
    "visuals": "visual shapes",
    "ground": "ground and gravity",
}
_DARK = "dark"
_NOBODY = "no body"
_MAX_EXAGGERATION = 50.0
_STEPS = 500  # Of a slider.
# The bar fits the panel in windows of up to 1800 pixels: it is at most 0.3 of this part of their height.
_SCALE_PART = 2.0
_SCALE = (
    '<div role="img" aria-label="Scale: {text}" style="width: {width:.3f}vh; margin: 0 auto 6px; padding-bottom: 2px; '
    'font-size: 12px; text-align: center; white-space: nowrap; border: solid; border-width: 0 1.5px 1.5px">{text}</div>'
)


class Controls(Protocol):
    """What the controls act on."""

    def toggle(self) -> None:
        """Play or pause."""

    def seek(self, time: float) -> None:
        """Go to a time of the motion [s]."""

    def set_speed(self, speed: float) -> None:
        """Play at so many seconds a second."""

    def set_layer(self, layer: str, visible: bool) -> None:
        """Show or hide a layer."""

    def set_exaggeration(self, factor: float) -> None:
        """Multiply elastic coordinates."""

    def slide(self, index: int, value: float) -> None:
        """Show the configuration with one slider moved."""

    def reset(self) -> None:
        """Show the configuration that was shown first."""

    def follow(self, body: str | None) -> None:
        """Let the camera go along with a body."""

    def set_dark(self, dark: bool) -> None:
        """Show page and picture in dark colours, or in light ones."""


class Panel:
    """The controls of one mechanism, in place of those of the one before.

    Args:
        server: Server of viser.
        controls: Object that the controls act on.
        drawing: Drawing whose name is the title.
        layers: Layers that are shown.
        sliders: Sliders of the coordinates.
        exaggeration: Exaggeration of the elastic ones; None where there are none.
        player: Player of the motion, if there is one.
        controls_shown: Whether there are any; the panel is empty and minimized otherwise.
        dark: Whether colours are dark.
        ghosts: Other runs that are shown.
        signals: Signals of the motion, to be plotted.
        bodies: Names of the bodies that the camera can follow.
    """

    def __init__(
        self,
        server: Any,
        controls: Controls,
        drawing: Drawing,
        layers: frozenset[str],
        sliders: tuple[Slider, ...],
        exaggeration: float | None,
        player: Player | None,
        controls_shown: bool = True,
        dark: bool = False,
        ghosts: Sequence[Ghost] = (),
        signals: Sequence[Signal] = (),
        bodies: Sequence[str] = (),
    ) -> None:
        self._gui = gui = server.gui
        self._controls = controls
        self._play: Any = None
        self._time: Any = None
        self._exaggeration: Any = None
        self._legend: Any = None
        self._followed: Any = None
        self.force_plot: ForcePlot | None = None
        self.signal_plot: SignalPlot | None = None
        self._boxes: dict[str, Any] = {}
        self._sliders: list[Any] = []
        gui.reset()
        self.set_dark(dark)
        gui.set_panel_label(drawing.name)
        self._status = gui.add_markdown("")
        self._warning = gui.add_markdown("")
        self._scale = gui.add_html("", visible=False)
        if not controls_shown:
            gui.main_panel.minimize()
            return
        gui.main_panel.dock_right()  # Beside the picture, not over it.
        if player is not None:
            self._add_player(player, ghosts)
            self.signal_plot = SignalPlot(gui, signals)
        self._add_layers(layers, exaggeration, player is not None and player.run is not None)
        self._followed = gui.add_dropdown("camera follows", (_NOBODY, *bodies), initial_value=_NOBODY)
        self._on(self._followed, lambda body: controls.follow(None if body == _NOBODY else body))
        self._boxes[_DARK] = gui.add_checkbox(_DARK, dark)
        self._on(self._boxes[_DARK], controls.set_dark)
        self._add_sliders(sliders)

    def _add_layers(self, layers: frozenset[str], exaggeration: float | None, acting: bool) -> None:
        """Boxes of the layers; those of forces where a run plays that tells of them."""
        gui, controls = self._gui, self._controls
        with gui.add_folder("Show"):
            if exaggeration is not None:
                most = max(_MAX_EXAGGERATION, 2 * exaggeration)
                self._exaggeration = gui.add_slider(
                    "exaggeration", 0.0, most, 0.5, max(exaggeration, 0.0), hint="multiplies the elastic coordinates"
                )
                self._on(self._exaggeration, controls.set_exaggeration)
            for layer in LAYERS:
                if layer not in ARROWS or acting:
                    self._boxes[layer] = gui.add_checkbox(_LAYER_NAMES.get(layer, layer), layer in layers)
                    self._on(self._boxes[layer], partial(controls.set_layer, layer))
            self._legend = gui.add_markdown("")

    def _on(self, handle: Any, act: Callable[[Any], None]) -> Any:
        """Call a function when a user changes a control; changes by this program have no client and are ignored."""
        handle.on_update(lambda event: act(event.target.value) if event.client is not None else None)
        return handle

    def _add_player(self, player: Player, ghosts: Sequence[Ghost]) -> None:
        gui, motion = self._gui, player.motion
        with gui.add_folder("Motion"):
            self._play = gui.add_button("Pause" if player.playing else "Play")
            self._play.on_click(lambda _: self._controls.toggle())
            length = max(motion.end - motion.start, 1e-9)
            self._time = gui.add_slider("time [s]", motion.start, motion.start + length, length / 1000, player.time)
            self._on(self._time, self._controls.seek)
            speeds = sorted({*_SPEEDS, f"{player.speed:g}"}, key=float)
            chosen = gui.add_dropdown("speed", speeds, initial_value=f"{player.speed:g}")
            self._on(chosen, lambda text: self._controls.set_speed(float(text)))
            if ghosts:
                gui.add_html(legend_of(ghosts))
        if player.run is not None and player.run.model.names.sections:
            self.force_plot = ForcePlot(gui, player.run)

    def _add_sliders(self, sliders: tuple[Slider, ...]) -> None:
        gui, handles = self._gui, {}
        for title, elastic in (("Coordinates", False), ("Elastic coordinates", True)):
            chosen = [i for i, slider in enumerate(sliders) if slider.elastic == elastic]
            if not chosen:
                continue
            with gui.add_folder(title, expand_by_default=not elastic):
                for i in chosen:
                    one = sliders[i]
                    step = (one.high - one.low) / _STEPS or 1.0
                    label = f"{one.label} [{one.unit}]" if one.unit else one.label
                    handle = gui.add_slider(label, one.low, one.high, step, float(np.clip(0.0, one.low, one.high)))
                    handles[i] = self._on(handle, partial(self._controls.slide, i))
        if sliders:
            gui.add_button("Reset").on_click(lambda _: self._controls.reset())
        self._sliders = [handles[i] for i in range(len(sliders))]

    def set_dark(self, dark: bool) -> None:
        """Show page and picture in dark colours, or in light ones."""
        self._gui.configure_theme(show_logo=False, show_share_button=False, dark_mode=dark)
        if _DARK in self._boxes:
            self._boxes[_DARK].value = dark

    def show_followed(self, body: str | None) -> None:
        """Set the control to the body that the camera follows."""
        if self._followed is not None:
            self._followed.value = body or _NOBODY

    def say(self, text: str) -> None:
        """Show a line of text above the controls."""
        self._status.content = text

    def warn(self, notes: Sequence[str]) -> None:
        """Show remarks on the state in the picture, in bold; nothing where there are none."""
        text = "\n\n".join(f"**Large bending:** {note}" for note in notes)
        if self._warning.content != text:
            self._warning.content = text

    def legend(self, texts: Sequence[str]) -> None:
        """Show the scales of the arrows."""
        if self._legend is not None:
            self._legend.content = "\n\n".join(texts)

    def scale(self, height: float | None) -> None:
        """Show a bar of a round length as the picture shows it, which is as high as the window.

        Args:
            height: Height of the picture at the depth of what its camera looks at [m]; None: there is none.
        """
        bar = scale_bar(height / _SCALE_PART) if height is not None and np.isfinite(height) and height > 0.0 else None
        self._scale.visible = bar is not None
        if bar is not None:
            self._scale.content = _SCALE.format(text=bar.text, width=100.0 * bar.share / _SCALE_PART)

    def show(self, layers: frozenset[str], exaggeration: float) -> None:
        """Set the controls to the displayed layers and the exaggeration."""
        for layer in LAYERS:
            if layer in self._boxes:
                self._boxes[layer].value = layer in layers
        if self._exaggeration is not None:
            self._exaggeration.value = float(np.clip(exaggeration, 0.0, self._exaggeration.max))

    def follow(self, values: Array, player: Player | None) -> None:
        """Let the controls stand where the picture is.

        Args:
            values: Values of the sliders (nv).
            player: Player of the motion, if there is one.
        """
        for handle, value in zip(self._sliders, values, strict=False):  # No sliders without controls.
            handle.value = float(np.clip(value, handle.min, handle.max))
        if player is not None and self._time is not None:
            self._time.value = player.time
            self._play.label = "Pause" if player.playing else "Play"
            if self.force_plot is not None:
                self.force_plot.follow(player.time)
