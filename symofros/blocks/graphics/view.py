"""Graphics: a mechanism in three dimensions in a browser, while a run goes on."""

from __future__ import annotations

import contextlib
import sys
import time
import webbrowser
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.quantities import motion_port
from symofros.blocks.turns import Turn
from symofros.description import System
from symofros.diagrams.block import Environment, Ports
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.errors import DescriptionError
from symofros.studio.viewer.playing.diagram_motion import chosen_block
from symofros.studio.viewer.viewer import Viewer


@dataclass(frozen=True, kw_only=True)
class View3D(ExternalBlock):
    """Shows a mechanism in a browser as its coordinates change (the extra `view`, docs/view.md).

    A run hands its coordinates over and goes on: what comes faster than pictures can be drawn is dropped. The mechanism
    is drawn with the parameters that the diagram states, whatever a single run or an event puts in their place; what is
    viewed or recorded after the run (`sf.view`, `sf.record`) has those of each instant.

    What it keeps of a run: "shown" and "dropped", how many samples were handed over, and how many of these were not
    drawn since newer ones came first.

    Attributes:
        model: Model of the mechanism.
        exaggeration: Factor of the elastic coordinates in the picture.
        port: Port of the page on this machine; 0 for any free one.
        paced: Whether the run waits at its samples for the clock, so that the motion is seen as fast as it is; a run in
            real time does so by itself.
        stays: Whether the page is there after the run, until the program ends or the next run takes it over.
        open_browser: Whether to open a browser; the address is written to standard error either way.
    """

    period: float | None = 0.04
    model: str
    exaggeration: float = 1.0
    port: int = 0
    paced: bool = False
    stays: bool = True
    open_browser: bool = True

    def ports(self, environment: Environment) -> Ports:
        """Coordinates q (nq); inputs u (nu), which matter where they prescribe motion."""
        if not (np.isfinite(self.exaggeration) and 0 <= self.port <= 65535):
            raise DescriptionError(
                f"block '{self.name}': can't show that",
                f"exaggeration {self.exaggeration}, port {self.port}",
                "exaggeration is a finite number, a port is from 0 to 65535",
                "port 0 is any free one",
            )
        record = environment.model(self.model)
        return Ports((motion_port("q", record, "q"), motion_port("u", record, "u", record.u_default)))

    def begin(self, environment: Environment) -> Running:
        """Serve the page, or take over that of the run before.

        Raises:
            SymofrosError: viser is not installed, the port is taken, or the page shows a run that has not ended.
        """
        turn: Turn = self.__dict__.setdefault("_turn", Turn())
        turn.take(self.name)
        try:
            viewer, par = self._serve(environment.system(self.model)), environment.parameters(self.model)
            viewer.show(environment.start(self.model)[0], par=par)
        except BaseException:
            turn.leave()
            raise
        return _Showing(self, viewer, par, turn)

    def _serve(self, system: System) -> Viewer:
        """The page, with a mechanism."""
        viewer = self.viewer
        if viewer is None or viewer.is_closed:
            viewer = Viewer(system, port=self.port, exaggeration=self.exaggeration)
            object.__setattr__(self, "_viewer", viewer)
            print(f"{self.name}: {viewer.url}", file=sys.stderr)
            if self.open_browser:
                webbrowser.open(viewer.url)
        elif viewer.mechanism.system != system:
            viewer.set_system(system)
        return viewer

    @property
    def viewer(self) -> Viewer | None:
        """The viewer of the last run; None before the first."""
        return self.__dict__.get("_viewer")

    def close(self) -> None:
        """Stop serving the page."""
        if self.viewer is not None:
            self.viewer.close()


class _Showing(Running):
    """One run on the page."""

    def __init__(self, block: View3D, viewer: Viewer, par: Array, turn: Turn) -> None:
        self._block, self._viewer, self._par, self._turn = block, viewer, par, turn
        self._dropped_before, self._shown = viewer.dropped, 0
        self._start: float | None = None  # When simulated time was zero, by the clock [s].

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Hand over one sample; wait for the clock if the run is paced by this block."""
        if self._block.paced:
            self._wait(t)
        self._viewer.push(t, inputs["q"], u=inputs["u"], par=self._par)
        self._shown += 1
        return {}

    def _wait(self, t: float) -> None:
        """Until the clock is at t."""
        now = time.monotonic()
        if self._start is None:
            self._start = now - t
        time.sleep(max(0.0, self._start + t - now))

    def kept(self) -> Mapping[str, Array]:
        """Number of samples handed to the viewer, and number of those dropped."""
        dropped = self._viewer.dropped - self._dropped_before
        return {"shown": np.asarray(float(self._shown)), "dropped": np.asarray(float(dropped))}

    def end(self) -> None:
        """Leave the page, or stop serving it."""
        if not self._block.stays:
            self._viewer.close()
        self._turn.leave()


def with_view(diagram: Diagram, block: str = "", **fields: Any) -> tuple[Diagram, View3D]:
    """The same diagram with a mechanism shown as it moves.

    Args:
        diagram: Diagram to run; it stays as it is.
        block: Block whose mechanism is shown; "" for the only one.
        fields: Fields of the View3D block.

    Returns:
        The diagram that has the block, and the block.

    Raises:
        UnknownNameError: There is no such mechanism, or there are several.
    """
    block = chosen_block(diagram.name, diagram.blocks, block)
    name = "view3d"
    while name in diagram.blocks:
        name += "_"
    added = View3D(name=name, model=diagram.blocks[block].mechanism(), **fields)
    sources = {"q": f"{block}.q"}
    with contextlib.suppress(KeyError):
        sources["u"] = diagram.wires[block, "u"]
    shown = replace(diagram, blocks=dict(diagram.blocks), wires=dict(diagram.wires))
    shown.add(added, **sources)
    return shown, added
