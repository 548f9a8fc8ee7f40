"""The mechanism in three dimensions beside the diagram: a viewer of the document, made when it is first asked for."""

from __future__ import annotations

import gzip
import math
from collections.abc import Callable
from threading import Lock
from typing import Any
from urllib.request import urlopen

import numpy as np

from symofros.base.measures import ANGLE, LENGTH
from symofros.description import System
from symofros.errors import Problem, SymofrosError
from symofros.studio.editor.editing.data_edits import EditError, four_parts, refusal
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.run_states import states_of
from symofros.studio.editor.jobs.worker import error_of
from symofros.studio.viewer.playing.motion import PlayedMotion, motion_of
from symofros.studio.viewer.viewer import Viewer

Json = dict[str, Any]

MAX_EXAGGERATION = 1000.0
GAP_UNITS = {LENGTH: "m", ANGLE: "rad"}
# Chromium starts no module worker from a blob of a page of no origin, and says so only to the page. Where a blob is
# refused at once, viser's page takes a data address, and that works.
NO_BLOB_WORKERS = b"""<script>
Worker = class extends Worker {
  constructor(file, options) {
    if (String(file).startsWith("blob:")) throw new Error("no workers from blobs here");
    super(file, options);
  }
};
</script>"""
BROKEN = Problem("the model has problems", "see their list", "what is drawn is a mechanism", "mend them")


class DocumentViewer:
    """View of the document, the same for all pages. Its methods may be called from any thread, and take turns.

    The viewer lives in this process: a picture costs milliseconds. Its poses are compiled when the mechanism changes.
    """

    def __init__(self, tell: Callable[[str, Json], None]) -> None:
        """Begin with nothing shown.

        Args:
            tell: Called with the name of an event and its data: "picked", the element that somebody clicks in the
                picture; "zoom", the height of the picture at the depth of what its camera looks at [m]; "posed", where
                everything stands after somebody dragged a frame.
        """
        self._turn, self._tell = Lock(), tell
        self._viewer: Viewer | None = None
        self._page: bytes | None = None
        self._motion: tuple[Json, PlayedMotion] | None = None
        self._fault: Json | None = None

    @property
    def socket(self) -> str | None:
        """Address of viser's own web socket; None while nothing is shown."""
        viewer = self._viewer
        return None if viewer is None else viewer.url.replace("http://", "ws://", 1)

    def follow(self, system: System | None) -> Json:
        """Show a system; the one before stays where this one can't be shown.

        Args:
            system: System of the document; None while it has problems.

        Returns:
            What the page's controls are made of.

        Raises:
            EditError: There is nothing to show yet, or viser is not installed.
        """
        with self._turn:
            self._fault = None
            if system is None:
                self._fault = four_parts(BROKEN)
            else:
                try:
                    self._show(system)
                except (SymofrosError, ValueError, ArithmeticError) as error:
                    self._fault = error_of(error)
            if self._viewer is None:
                raise EditError(_problem(self._fault or {}))
            return self._as_json(self._viewer)

    def _show(self, system: System) -> None:
        if self._viewer is None:
            self._viewer = Viewer(
                system,
                port=0,
                controls=False,
                on_pick=lambda element: self._tell("picked", {"element": element}),
                on_zoom=lambda height: self._tell("zoom", {"height": height}),
            )
        elif self._viewer.mechanism.system != system:
            self._viewer.set_system(system)

    def pose(self, body: Json) -> Json:
        """Move it or change its looks.

        Args:
            body: `q`, `par` {name: value}, `exaggeration`, `dark`, `frames`, `labels`, `marked` elements, `reset`,
                `drag`: a frame that gets a handle, "" for none.

        Returns:
            Where everything stands then, and why loops could not be closed.

        Raises:
            EditError: Nothing is shown, or the request is malformed or names what is not there.
        """
        q, par = _numbers(body, "q"), _numbers(body, "par")
        factor = body.get("exaggeration")
        if factor is not None and not (_finite(factor) and abs(factor) <= MAX_EXAGGERATION):
            raise _malformed("exaggeration", factor, f"a number up to {MAX_EXAGGERATION:g}")
        marked = body.get("marked")
        if marked is not None and not (isinstance(marked, list) and all(isinstance(each, str) for each in marked)):
            raise _malformed("marked", marked, "a list of elements' names")
        with self._turn:
            viewer = self._viewer
            if viewer is None:
                raise _nothing_shown()
            if body.get("reset") is True:
                viewer.reset()
            for layer in ("frames", "labels"):
                if isinstance(body.get(layer), bool):
                    viewer.set_layer(layer, body[layer])
            if isinstance(body.get("dark"), bool):
                viewer.set_dark(body["dark"])
            if marked is not None:
                viewer.mark(marked)
            if factor is not None:
                viewer.exaggeration = float(factor)
            try:
                if isinstance(body.get("drag"), str):
                    viewer.drag(body["drag"] or None, lambda: self._tell("posed", {**_stand(viewer), "why": ""}))
                why = viewer.move(q, par) if q or par else ""
            except SymofrosError as error:
                raise EditError(_problem(error_of(error))) from None
            return {**_stand(viewer), "why": why and why.partition("\n")[0]}

    def seek(self, run: Json, time: Any) -> Json:
        """Show the state of a run at a time.

        Args:
            run: Result of the simulation, as `operations.simulate` gives it.
            time: Time [s]; the first or the last of the run if it is outside.

        Returns:
            Where everything stands then.

        Raises:
            EditError: Nothing is shown, the run is of another mechanism, or the time is none.
        """
        if not _finite(time):
            raise _malformed("t", time, "a finite number of seconds")
        with self._turn:
            viewer = self._viewer
            if viewer is None:
                raise _nothing_shown()
            model = viewer.mechanism.model
            names = tuple(series["name"] for series in run["series"] if series["kind"] == "q")
            if names != model.names.q:
                raise refusal(
                    "the run does not fit the model that is shown",
                    f"coordinates {', '.join(names[:12])}",
                    f"the model has {', '.join(model.names.q[:12])}",
                    "simulate again",
                )
            if self._motion is None or self._motion[0] is not run or self._motion[1].model is not model:
                try:
                    self._motion = run, motion_of(model, states_of(run))
                except SymofrosError as error:
                    raise EditError(_problem(error_of(error))) from None
            motion = self._motion[1]
            q, u, par = motion.at(float(np.clip(time, motion.start, motion.end)))
            viewer.show(q, u=u, par=par)
            return {**_stand(viewer), "why": ""}

    def _as_json(self, viewer: Viewer) -> Json:
        coordinates = [
            {
                "name": slider.label,
                "unit": slider.unit,
                "low": slider.low,
                "high": slider.high,
                "elastic": slider.elastic,
            }
            for slider in viewer.sliders
        ]
        return {
            "coordinates": coordinates,
            "flexible": viewer.mechanism.is_flexible,
            "run_time": list(viewer.mechanism.model.names.par),
            "fault": self._fault,
            "height": viewer.picture_height,
            **_stand(viewer),
        }

    def page(self) -> bytes | None:
        """The page of viser, fit for a frame of no origin (gzip); None while nothing is shown."""
        with self._turn:
            if self._viewer is not None and self._page is None:
                with urlopen(self._viewer.url, timeout=10) as answer:
                    page = answer.read().replace(b"<head>", b"<head>" + NO_BLOB_WORKERS, 1)
                self._page = gzip.compress(page, mtime=0)
            return self._page

    def close(self) -> None:
        """Stop serving."""
        with self._turn:
            if self._viewer is not None:
                self._viewer.close()
                self._viewer = None


def _stand(viewer: Viewer) -> Json:
    """State of the view: coordinates, exaggeration, frames, gap of the loops and bending of the beams.

    `gap`: largest residual of the loops' conditions, None without loops, in `gap_unit`, "" of a formula; `beams`: how
    far each is bent.
    """
    model, state = viewer.mechanism.model, viewer.state
    gap, unit = None, ""
    if model.nc:
        open_by = np.abs(model.constraint(state.q, u=state.u, par=state.par))
        worst = int(np.argmax(open_by))
        gap, unit = float(open_by[worst]), GAP_UNITS.get(model.record.measures.unit[worst], "")
    labels = (slider.label for slider in viewer.sliders)
    return {
        "q": dict(zip(labels, viewer.values.tolist(), strict=True)),
        "exaggeration": viewer.exaggeration,
        "gap": gap,
        "gap_unit": unit,
        "frames": "frames" in viewer.layers,
        "beams": bent_beams(viewer.bendings),
    }


def _finite(number: Any) -> bool:
    return type(number) in (int, float) and abs(number) < 1e300 and math.isfinite(number)


def _numbers(body: Json, key: str) -> dict[str, float]:
    given = body.get(key) or {}
    if not isinstance(given, dict) or not all(map(_finite, given.values())):
        raise _malformed(key, given, "a mapping of names to finite numbers")
    return {str(name): float(value) for name, value in given.items()}


def _nothing_shown() -> EditError:
    rule = "a pose is of the mechanism that is shown"
    return refusal("nothing is shown", "no view", rule, "open the 3-D pane first")


def _malformed(what: str, found: Any, rule: str) -> EditError:
    return refusal(f"{what} of the request is malformed", f"{found!r:.100}", rule, "reload the page")


def _problem(parts: Json) -> Problem:
    return Problem(parts["object"], parts["found"], parts["rule"], parts["remedy"])
