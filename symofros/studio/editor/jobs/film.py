"""A simulated motion as a film, with its time and its exaggeration written on it."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from symofros.description import System
from symofros.errors import SymofrosError
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.jobs.run_states import states_of
from symofros.studio.viewer.record import record

Json = dict[str, Any]

MEDIA_TYPES = {"gif": "image/gif", "mp4": "video/mp4"}
SIZE = (640, 480)
RATE = 20.0
MAX_SECONDS = 60.0


def film_of(system: System | None, result: Json, suffix: str, exaggeration: str, speed: str) -> bytes:
    """The film of a simulation, as far as it did not diverge.

    Args:
        system: System that was simulated; None where the document is another by now.
        result: Result of the simulation, as `operations.simulate` gives it.
        suffix: "gif" or "mp4".
        exaggeration: Factor of the elastic coordinates, as the request states it.
        speed: Seconds of the motion a second, as the request states it.

    Raises:
        EditError: Another suffix, a number that is none, a film of more than a minute, another document, or a package
            that is not installed.
    """
    if suffix not in MEDIA_TYPES:
        raise EditError("no such film", f"'{suffix[:20]}'", f"one of {', '.join(MEDIA_TYPES)}", "choose one of them")
    if system is None:
        rule = "a film is of the model as it was simulated"
        raise EditError("the model has changed since", "an outdated run", rule, "simulate again, or undo the change")
    states = states_of(result)
    t, q = np.asarray(states.t), np.asarray(states.q)
    until = int(np.argmin([*np.isfinite(q).all(axis=1), False]))
    factor, pace = _number("exaggeration", exaggeration), _number("speed", speed)
    if until > 0 and pace > 0.0 and (t[until - 1] - t[0]) / pace > MAX_SECONDS:
        rule = f"a film of the page takes {MAX_SECONDS:g} s at most"
        raise EditError("the film is too long", f"{(t[until - 1] - t[0]) / pace:g} s", rule, "raise the speed")
    shown = states._replace(t=t[:until], q=q[:until], u=np.asarray(states.u)[:until])
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"film.{suffix}"
        try:
            record(system, shown, file, exaggeration=factor, speed=pace, rate=RATE, size=SIZE, caption=True)
        except SymofrosError as error:
            raise EditError(error.problem) from None
        return file.read_bytes()


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise EditError(
            f"{name} of the request is no number", f"'{text[:20]}'", "a number", "reload the page"
        ) from None
