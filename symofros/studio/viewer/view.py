"""One call to look at a mechanism."""

from __future__ import annotations

import os
import webbrowser
from collections.abc import Mapping, Sequence
from typing import Any

from symofros.base.arguments import checked
from symofros.description import System
from symofros.diagrams.result import DiagramRun
from symofros.errors import SymofrosError
from symofros.loading import load
from symofros.runtime.model import ArrayLike
from symofros.studio.viewer.page.viser_server import LOOPBACK, PORT
from symofros.studio.viewer.playing.diagram_motion import played, shown_system_and_states
from symofros.studio.viewer.playing.motion import Played
from symofros.studio.viewer.viewer import Viewer


@checked
def view(
    system: System | DiagramRun | str | os.PathLike[str],
    run: Played | None = None,
    *,
    block: str = "",
    q: ArrayLike | None = None,
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    exaggeration: float = 1.0,
    speed: float = 1.0,
    ghosts: Mapping[str, Played | DiagramRun] | None = None,
    signals: Mapping[str, ArrayLike] | None = None,
    paths: Sequence[Sequence[Any]] = (),
    host: str = LOOPBACK,
    port: int = PORT,
    browser: bool = True,
) -> Viewer:
    """Look at a mechanism: serve it as a page, and open that in the browser.

    Returns at once, so that a notebook or a loop can go on; a script that ends takes the page with it, unless it calls
    `wait()` on what is returned.

    Args:
        system: A system, or the path of a description; or a diagram's run, whose motion is played.
        run: A motion to play: a trajectory of the system, or times (n) and coordinates (n, nq).
        block: Block of a diagram's run: the block whose mechanism is shown; where there is one only, that.
        q: Otherwise coordinates (nq) to show; by default neutral ones, with loops closed.
        u: Inputs (nu), for prescribed motions.
        par: Run-time parameters (npar).
        exaggeration: Factor of the elastic coordinates in the picture.
        speed: Seconds of the motion a second.
        ghosts: Other runs of the mechanism by names for the legend, transparent beside the motion, at the same times.
        signals: More to plot over time beside coordinates, inputs and energies, by name: a value, or several, at each
            time of the run (n) or (n, k).
        paths: Curves drawn beside it, as of `Viewer`.
        host: Address that it is served at.
        port: Port of the page; 0 for any free one.
        browser: Whether to open the page.

    Returns:
        The viewer, to show, push, play and close.

    Raises:
        DescriptionError: The system can't be read, or can't be a mechanism.
        ShapeError: An array does not fit the model, or a path can't be drawn.
        UnknownNameError: The diagram's run has no such mechanism, or several.
        SymofrosError: viser is not installed, the address can't be served at, or ghosts can't be shown.
    """
    if isinstance(system, DiagramRun):
        stated, run = shown_system_and_states(system, block)
    else:
        stated = system if isinstance(system, System) else load(system)
    if ghosts and run is None:
        rule = "ghosts are beside a motion, at the same times"
        raise SymofrosError("view: ghosts of no motion", "no run", rule, "give the run that plays")
    viewer = Viewer(stated, host=host, port=port, exaggeration=exaggeration, paths=paths)
    try:
        if run is not None:
            viewer.play(run, speed=speed, ghosts=played(ghosts, block), signals=signals)
        elif q is not None or u is not None or par is not None:
            viewer.show(q, u=u, par=par)
    except Exception:
        viewer.close()
        raise
    if browser:
        webbrowser.open(viewer.url)
    return viewer
