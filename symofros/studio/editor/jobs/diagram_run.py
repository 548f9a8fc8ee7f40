"""The operation "run" of worker processes: a diagram runs, and its plots are sent while it does."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.diagrams.result import DiagramRun
from symofros.diagrams.run.plots import plots_of
from symofros.diagrams.settings import Plot
from symofros.diagrams.signals import entries, split
from symofros.diagrams.simulation import Simulation
from symofros.diagrams.wiring import Source, Wired
from symofros.runtime.beams import BEAM_LIMIT
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.request import Json, Tell, diagram_of, number_of

# Points of a curve that are sent at most at the end, and with one message meanwhile.
MAX_POINTS, MAX_TOLD = 3000, 200
MAX_PLOTS, MAX_STOPS = 50, 1000
SETTINGS = ("dt", "record", "rtol", "atol", "realtime")


def run_diagram(request: Json, tell: Tell) -> Json:
    """Run a diagram, compiled or block by block; curves of its plots."""
    tell(0, 100, "reading")
    diagram, options = diagram_of(request), request.get("options", {})
    simulation = Simulation(diagram)
    wired = simulation.resolved.wired
    plots = (plots_of(wired) or [Plot(name, (name,)) for name in _outputs(wired)])[:MAX_PLOTS]
    given = [key for key in SETTINGS if options.get(key) is not None]
    asked: Json = {key: number_of(options[key], key, from_zero=True) for key in given}
    if options.get("method"):
        asked["method"] = str(options["method"])
    settings = diagram.simulation.keywords_with(asked)
    t_end = number_of(options.get("t_end") or diagram.simulation.t_end or 1.0, "t_end", from_zero=True)
    stops = [number_of(stop, "a breakpoint", from_zero=True) for stop in (options.get("breakpoints") or [])[:MAX_STOPS]]
    observer = LiveObserver(tell, wired, plots, t_end, stops)
    interpreted = options.get("mode") == "interpreted"
    tell(0, 100, "compiling each block" if interpreted else "compiling the diagram")
    began = time.perf_counter()
    if interpreted:
        fixed = {key: settings[key] for key in ("t0", "dt", "method", "record") if key in settings}
        interpretation = simulation.interpret(t_end, **fixed, observer=observer)
        t, signals, outcome = interpretation.t, interpretation, interpretation.outcome
        cost = {"steps": interpretation.steps, "loop_s": time.perf_counter() - began}
    else:
        compiled = simulation.compiled
        sources = list(dict.fromkeys([*observer.sources, *_drawn(wired)]))
        compiled.signals(sources)
        began = time.perf_counter()
        run: DiagramRun = simulation.run(t_end, **settings, observer=observer)
        run.compute(sources)
        outcome = run.outcome
        cost = {"steps": run.cost.steps, "loop_s": run.cost.worked}
        t, signals = run.t, run  # type: ignore[assignment]
    end: Json = {"ok": outcome.ok, **outcome.as_data()}
    end |= {"ok": True, "reason": "stopped where you said"} if observer.ended else {}
    kept = _thinned(len(t), MAX_POINTS)
    return {
        "mode": "interpreted" if interpreted else "compiled",
        "method": settings.get("method", "rk4"),
        "t": _floats(t[kept]),
        "plots": [
            {**plot, "curves": [{**one, "values": _floats(_entry(signals, one["name"])[kept])} for one in curves]}
            for plot, curves in observer.shown
        ],
        "motions": {block: _motion(wired, block, signals, t, kept) for block in wired.mechanisms()},
        "beams": bent_beams(signals.bendings, settings.get("beam_limit", BEAM_LIMIT)),
        "outcome": end,
        "wall_s": time.perf_counter() - began,
        **cost,
    }


class LiveObserver:
    """Tells the page of a run while it goes on, and follows its orders: pause, resume, stop.

    Args:
        tell: Way to the page.
        wired: Diagram that runs.
        plots: Plots whose curves are sent.
        t_end: End time [s].
        stops: Times at which the run waits until the page lets it go on [s].

    Attributes:
        signals: Outputs that are sent.
        sources: The same as (block, output).
        shown: Each plot as the page has it, and its curves, without their values.
        ended: Whether the page ended the run.
    """

    def __init__(self, tell: Tell, wired: Wired, plots: Sequence[Plot], t_end: float, stops: Iterable[float]) -> None:
        self._tell, self._t_end, self._stops = tell, t_end, sorted(stops)
        self.shown = [({"title": plot.title, "xy": plot.xy}, _curves(wired, plot)) for plot in plots]
        self._names = list(dict.fromkeys(one["name"] for _, curves in self.shown for one in curves))
        self.signals = list(dict.fromkeys(split(name)[0] for name in self._names))
        self.sources = list(map(wired.output, self.signals))
        self.ended = self._paused = False
        sent_plots = [{**plot, "curves": curves} for plot, curves in self.shown]
        tell.say({"samples": {"plots": sent_plots, "t": [], "values": []}})

    def stop(self) -> float:
        """The next breakpoint."""
        return self._stops[0] if self._stops else math.inf

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        """Tell the records, and wait while the run is paused.

        Raises:
            KeyboardInterrupt: The page ends the run.
        """
        kept = _thinned(len(times), MAX_TOLD)
        columns = [_floats(_entry(values, name)[kept]) for name in self._names]
        self._tell.say({"samples": {"plots": None, "t": _floats(times[kept]), "values": columns}})
        while self._stops and t >= self._stops[0] - 1e-9:
            del self._stops[0]
            self._paused = t < self._t_end
        while True:
            while not self._tell.orders.empty():
                self._follow(self._tell.orders.get())
            percent = min(99, int(100 * t / self._t_end)) if self._t_end > 0.0 else 0
            word = "paused at " if self._paused else ""
            self._tell(percent, 100, f"{word}t = {t:.4g} s", self._paused)
            if not self._paused:
                return
            self._follow(self._tell.orders.get())

    def _follow(self, order: str) -> None:
        self._paused = order == "pause"
        if order == "stop":
            self.ended = True
            raise KeyboardInterrupt


def _outputs(wired: Wired) -> list[str]:
    return [f"{block}.{port.name}" for block, ports in wired.ports.items() for port in ports.outputs]


def _curves(wired: Wired, plot: Plot) -> list[Json]:
    """Name, unit and signal of each curve; over a plane, of both entries that a curve is made of."""
    curves: list[Json] = []
    for text in plot.signals:
        name, index = split(text)
        source = wired.output(name)
        names = [text] if index is not None else [each for each, _ in entries(name, wired.shape(source))]
        unit = wired.unit(source)
        curves += [{"name": each, "unit": unit, "signal": text} for each in (names[:2] if plot.xy else names)]
    return curves


def _drawn(wired: Wired) -> list[Source]:
    """Signals that pictures of the mechanisms are made of: coordinates, and inputs where motions are prescribed."""
    blocks = wired.mechanisms()
    driving = [source for source in map(wired.driving, blocks) if source is not None]
    return [*((block, "q") for block in blocks), *driving]


def _motion(wired: Wired, block: str, signals: Any, t: Array, kept: npt.NDArray[np.int64]) -> Json:
    """The motion of a block's mechanism, of the form of a simulation: times, coordinates and inputs, parameters."""
    model = wired.blocks[block].mechanism()
    record = wired.models.record(model)
    fed = wired.driving(block)
    u = np.tile(np.array(record.u_default), (len(t), 1)) if fed is None else np.asarray(signals[".".join(fed)])
    groups = (("q", record.q_names, np.asarray(signals[f"{block}.q"])), ("u", record.u_names, u))
    return {
        "t": _floats(t[kept]),
        "series": [
            {"name": name, "kind": kind, "values": _floats(values[kept, i])}
            for kind, names, values in groups
            for i, name in enumerate(names)
        ],
        "par": wired.models.parameters(model).tolist(),
    }


def _entry(values: Any, name: str) -> Array:
    """One entry of a signal over time (n)."""
    signal, index = split(name)
    column: Array = np.asarray(values[signal])
    for i in index or ():
        column = column[:, i]
    return column


def _thinned(n: int, most: int) -> npt.NDArray[np.int64]:
    """Which of n records are sent: all, or as many as allowed, the last one always."""
    if n <= most:
        return np.arange(n, dtype=np.int64)
    return np.unique(np.linspace(0, n - 1, most).round().astype(np.int64))


def _floats(values: Array) -> list[float | None]:
    """Numbers as JSON holds them, with the figures that a plot can show; None where one is not finite."""
    return [float(f"{x:.7g}") if math.isfinite(x) else None for x in np.asarray(values, dtype=np.float64).tolist()]
