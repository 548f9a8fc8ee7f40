"""The mechanism in three dimensions beside the diagram: a viewer of the document, made when it is first asked for."""

from __future__ import annotations

import gzip
import math
from collections.abc import Callable
from threading import Lock
from typing import Any, NamedTuple
from urllib.request import urlopen

import numpy as np

from symofros.base.measures import ANGLE, LENGTH
from symofros.description import System
from symofros.errors import Problem, SymofrosError
from symofros.studio.editor.editing.data_edits import EditError, four_parts
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.run_states import states_of, trajectory_of
from symofros.studio.editor.jobs.worker import error_of
from symofros.studio.viewer.drawing.layers import ARROWS
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.playing.motion import PlayedMotion, motion_of
from symofros.studio.viewer.playing.run_forces import RunForces
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


_NO_RUN = "Forces are those of a simulated motion: simulate, then move its time."


class _Forces(NamedTuple):
    """Forces of a run.

    Attributes:
        run: The run, as of `DocumentViewer.seek`.
        mechanism: Mechanism that is drawn.
        forces: Its forces; None where it has none.
        why: Why not.
    """

    run: Json
    mechanism: Mechanism
    forces: RunForces | None
    why: str

    @classmethod
    def of(cls, run: Json, mechanism: Mechanism) -> _Forces:
        """Forces of a run of a mechanism."""
        try:
            trajectory = trajectory_of(mechanism.moving, run)
            if trajectory is None:
                return cls(run, mechanism, None, "No forces: this motion has no speeds.")
            forces = RunForces(trajectory, mechanism.tree, mechanism.drawing(trajectory.par))
        except SymofrosError as error:
            return cls(run, mechanism, None, f"No forces: {error.problem.what}")
        return cls(run, mechanism, forces, "")

    def legend(self, layers: frozenset[str]) -> list[str]:
        """Scales of the layers that are shown, or why there are no forces, in words."""
        return [self.why] if self.forces is None else self.forces.legend(layers)


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
        self._forces: _Forces | None = None  # Of the run that was shown last with its forces.
        self._is_of_run = False  # What is shown now.
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
            self._is_of_run = False

    def pose(self, body: Json) -> Json:
        """Move it or change its looks.

        Args:
            body: `q`, `par` {name: value}, `exaggeration`, `dark`, `frames`, `labels`, `marked` elements, `reset`,
                `forces`, `moments`, `drag`: a frame that gets a handle, "" for none.

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
            for layer in ("frames", "labels", *ARROWS):
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
                    viewer.drag(body["drag"] or None, lambda: self._dragged(viewer))
                why = viewer.move(q, par) if q or par else ""
            except SymofrosError as error:
                raise EditError(_problem(error_of(error))) from None
            self._is_of_run = self._is_of_run and not (q or par or body.get("reset") is True)
            return {**self._stand(viewer), "why": why and why.partition("\n")[0]}

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
                raise EditError(
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
            at = float(np.clip(time, motion.start, motion.end))
            q, u, par = motion.at(at)
            forces = self._forces_of(run, viewer)
            viewer.show(q, u=u, par=par, acting=None if forces is None else (forces, at))
            self._is_of_run = True
            return {**self._stand(viewer), "why": ""}

    def _forces_of(self, run: Json, viewer: Viewer) -> RunForces | None:
        """Forces of a run where they are shown; formed when they are first asked for."""
        if viewer.layers.isdisjoint(ARROWS):
            return None
        known = self._forces
        if known is None or known.run is not run or known.mechanism is not viewer.mechanism:
            self._forces = known = _Forces.of(run, viewer.mechanism)
        return known.forces

    def _dragged(self, viewer: Viewer) -> None:
        self._is_of_run = False
        self._tell("posed", {**self._stand(viewer), "why": ""})

    def _stand(self, viewer: Viewer) -> Json:
        """State of the view, with the scales of the arrows that are shown, or why there are none."""
        shown, legend = viewer.layers & ARROWS.keys(), []
        if shown:
            is_known = self._is_of_run and self._forces is not None
            legend = self._forces.legend(viewer.layers) if is_known and self._forces is not None else [_NO_RUN]
        return {**_stand(viewer), "forces": bool(shown), "legend": legend}

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
            **self._stand(viewer),
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
    if viewer.mechanism.system.constraints:  # Not of rigid contacts, which are open in a pose.
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
    return EditError("nothing is shown", "no view", rule, "open the 3-D pane first")


def _malformed(what: str, found: Any, rule: str) -> EditError:
    return EditError(f"{what} of the request is malformed", f"{found!r:.100}", rule, "reload the page")


def _problem(parts: Json) -> Problem:
    return Problem(parts["object"], parts["found"], parts["rule"], parts["remedy"])
