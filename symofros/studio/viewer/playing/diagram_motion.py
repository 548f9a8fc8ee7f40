"""What a run of a diagram shows: one of its mechanisms, and how that moved."""

from __future__ import annotations

from collections.abc import Mapping

from symofros.description import System
from symofros.diagrams.block import Block
from symofros.diagrams.result import DiagramRun
from symofros.errors import UnknownNameError, did_you_mean
from symofros.studio.viewer.playing.motion import Played, States


def chosen_block(name: str, blocks: Mapping[str, Block], block: str = "") -> str:
    """The block whose mechanism is shown.

    Args:
        name: Name of the diagram.
        blocks: Name -> block.
        block: Name of the block; "" for the only one that moves a mechanism.

    Raises:
        UnknownNameError: There is no such block, it moves no mechanism, or there are several to choose from.
    """
    moving = [key for key, item in blocks.items() if item.mechanism()]
    if block in moving:
        return block
    if not block and len(moving) == 1:
        return moving[0]
    remedy = "name one of them" if moving else "add forward dynamics"
    rule = f"blocks that move one: {', '.join(moving) or 'none'}"
    if block:
        what, actual = f"view of diagram '{name}': no mechanism '{block}'", f"'{block}'"
        remedy = did_you_mean(block, moving) or remedy
    else:
        what, actual = f"view of diagram '{name}': which mechanism?", f"{len(moving)} mechanisms"
    raise UnknownNameError(what, actual, rule, remedy)


def shown_system_and_states(run: DiagramRun, block: str = "") -> tuple[System, States]:
    """The mechanism that a block moves, and its states over time, with the run's own parameters as events set them.

    Raises:
        UnknownNameError: As `chosen_block`.
    """
    resolved = run.compiled.resolved
    wired, layout = resolved.wired, resolved.layout
    block = chosen_block(wired.name, wired.blocks, block)
    model = wired.blocks[block].mechanism()
    # Signals are computed by a function of their own: only where they move something is that worth its while.
    source = wired.driving(block)
    u = None if source is None else run[".".join(source)]
    par = layout.parameters_of(block, model, layout.present(run.par, run.u))
    return wired.models.system(model), States(run.t, run.motion(block)[0], u, par)


def played(runs: Mapping[str, Played | DiagramRun] | None, block: str = "") -> dict[str, Played]:
    """Runs by name, those of diagrams as states of the mechanism that a block moves.

    Raises:
        UnknownNameError: As `chosen_block`.
    """
    return {
        name: shown_system_and_states(run, block)[1] if isinstance(run, DiagramRun) else run
        for name, run in (runs or {}).items()
    }
