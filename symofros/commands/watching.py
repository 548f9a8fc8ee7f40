"""What `symofros simulate` shows: a run as it goes, or afterwards, in a browser or in a file."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from symofros.blocks.view import View3D, with_view
from symofros.description.system import System
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.result import DiagramRun
from symofros.simulation.trajectory import Trajectory
from symofros.studio.viewer.of_run import chosen_block, shown_of
from symofros.studio.viewer.record import check_suffix, record
from symofros.studio.viewer.server import load_viser
from symofros.studio.viewer.view import view


@dataclass(frozen=True)
class Look:
    """What the command line asks to see.

    Attributes:
        view: Whether to open the viewer.
        block: Block of a diagram: whose mechanism; "" for the only one.
        output: File to record to.
        exaggeration: What multiplies elastic coordinates.
    """

    view: bool = False
    block: str = ""
    output: Path | None = None
    exaggeration: float = 1.0

    def check(self) -> None:
        """Refuse before the run what could not be done after it.

        Raises:
            SymofrosError: The file has another suffix, or viser is not installed.
        """
        if self.output is not None:
            check_suffix(self.output)
        if self.view:
            load_viser()


def prepared(diagram: Diagram, look: Look, keeps_pace: bool) -> tuple[Diagram, View3D | None]:
    """The diagram to run, and the block in it that shows it, if it keeps pace with the clock.

    Raises:
        SymofrosError: As `Look.check`; or the mechanism to be shown is not there, or not the only one.
    """
    look.check()
    if look.view and keeps_pace:
        return with_view(diagram, look.block, exaggeration=look.exaggeration)
    if look.view or look.output is not None:
        chosen_block(diagram.name, diagram.blocks, look.block)
    return diagram, None


def recorded(run: DiagramRun | Trajectory, look: Look, system: System | None = None) -> list[str]:
    """Record a run as asked; the files written.

    Args:
        run: Run of a diagram, or of a model.
        look: What is asked.
        system: The model's.
    """
    if look.output is None:
        return []
    if isinstance(run, DiagramRun):
        return [str(record(run, look.output, block=look.block, exaggeration=look.exaggeration))]
    assert system is not None
    return [str(record(system, run, look.output, exaggeration=look.exaggeration))]


def shown(run: DiagramRun | Trajectory, look: Look, system: System | None = None, live: View3D | None = None) -> None:
    """Play a run in the viewer, if asked, until the user interrupts.

    Args:
        run: Run of a diagram, or of a model.
        look: What is asked.
        system: The model's.
        live: What showed the run as it went: its page plays it now.
    """
    if not look.view:
        return
    if live is not None and live.viewer is not None and isinstance(run, DiagramRun):
        viewer = live.viewer
        viewer.play(shown_of(run, look.block)[1])
    elif isinstance(run, DiagramRun):
        viewer = view(run, block=look.block, exaggeration=look.exaggeration, port=0)
    else:
        assert system is not None
        viewer = view(system, run, exaggeration=look.exaggeration, port=0)
    with viewer:
        print(f"it plays at {viewer.url} (Ctrl-C ends)", file=sys.stderr, flush=True)
        viewer.wait()
