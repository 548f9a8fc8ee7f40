"""What `symofros simulate` shows: a run as it goes, or afterwards, in a browser or in a file."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from symofros.base.stored import check_writable
from symofros.blocks.graphics.view import View3D, with_view
from symofros.description import System
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.result import DiagramRun
from symofros.errors import SymofrosError
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.page.viser_server import load_viser
from symofros.studio.viewer.playing.diagram_motion import chosen_block, shown_system_and_states
from symofros.studio.viewer.record import check_suffix, record
from symofros.studio.viewer.view import view


@dataclass(frozen=True)
class ViewOptions:
    """Options of the command line about viewing and recording.

    Attributes:
        view: Whether to open the viewer.
        block: Mechanism block of a diagram to be shown; "" for the only one.
        output: File to record to.
        exaggeration: Factor on elastic coordinates in the picture.
        interactive: Whether the page that is recorded simulates on.
    """

    view: bool = False
    block: str = ""
    output: Path | None = None
    exaggeration: float = 1.0
    interactive: bool = False

    def check(self) -> None:
        """Check options whose errors would otherwise surface only after the run.

        Raises:
            SymofrosError: The file has another suffix, or viser is not installed; or no page is to simulate on.
            OSError: The file can't be written.
            CompileError: The page is to simulate, and ziglang is not installed.
        """
        if self.interactive:
            if self.output is None or self.output.suffix != ".html":
                stated = str(self.output or "no --record-view")
                rule, remedy = "the page of a replay simulates on", "--record-view FILE.html"
                raise SymofrosError("--interactive: there is no page", stated, rule, remedy)
            from symofros.exports.wasm import wasm  # Exports take long to import: no run else needs them.

            wasm.check_compiler()
        if self.output is not None:
            check_suffix(self.output)
            check_writable(self.output)
        if self.view:
            load_viser()


def with_live_view(diagram: Diagram, options: ViewOptions, keeps_pace: bool) -> tuple[Diagram, View3D | None]:
    """The diagram to run, and the block in it that shows it, if it keeps pace with the clock.

    Raises:
        SymofrosError: As `ViewOptions.check`; or the page is to simulate on; or the mechanism to be shown is not there,
            or not the only one.
        OSError: As `ViewOptions.check`.
    """
    if options.interactive:
        rule, remedy = "the page simulates models: blocks are not in it", "leave --interactive out"
        raise SymofrosError("--interactive: the file is a diagram", diagram.name, rule, remedy)
    options.check()
    if options.view and keeps_pace:
        return with_view(diagram, options.block, exaggeration=options.exaggeration)
    if options.view or options.output is not None:
        chosen_block(diagram.name, diagram.blocks, options.block)
    return diagram, None


def record_run(run: DiagramRun | Trajectory, options: ViewOptions, system: System | None = None) -> list[str]:
    """Record a run if asked, and return the files written."""
    if options.output is None:
        return []
    if isinstance(run, DiagramRun):
        return [str(record(run, options.output, block=options.block, exaggeration=options.exaggeration))]
    assert system is not None
    factor, onward = options.exaggeration, options.interactive
    return [str(record(system, run, options.output, exaggeration=factor, simulate=onward))]


def show_run(
    run: DiagramRun | Trajectory, options: ViewOptions, system: System | None = None, live: View3D | None = None
) -> None:
    """Play a run in the viewer, if asked, until the user interrupts.

    Args:
        run: Run of a diagram, or of a model.
        options: Options of the command line.
        system: System of a model's run.
        live: Block that showed the run as it went; its page replays the run.
    """
    if not options.view:
        return
    if live is not None and live.viewer is not None and isinstance(run, DiagramRun):
        viewer = live.viewer
        viewer.play(shown_system_and_states(run, options.block)[1])
    elif isinstance(run, DiagramRun):
        viewer = view(run, block=options.block, exaggeration=options.exaggeration, port=0)
    else:
        assert system is not None
        viewer = view(system, run, exaggeration=options.exaggeration, port=0)
    with viewer:
        print(f"it plays at {viewer.url} (Ctrl-C ends)", file=sys.stderr, flush=True)
        viewer.wait()
