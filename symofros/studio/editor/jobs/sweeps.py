"""Analyses by their names; those of many models or runs: sweeps of a parameter, advice on what may be left out.

Each analysis returns tables, plots and motions as data, which the page draws without knowing the analysis:

    title      what was computed, in one line
    tables     caption, heads of the columns, rows of a name and its values (text, number, null where not finite)
    plots      title, what the axes measure, curves of x and y
    motions    name -> t, series, par: a motion that the 3-D view plays, as that of a simulation
    start      coordinates to simulate from; null where there are none
    model      name and text of a model that was found; null where there is none
    notes      remarks
    beams      how far each beam is bent
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import symofros as sf
from symofros.base.arrays import Array
from symofros.base.names import rate_symbol, speed_column, symbol_of
from symofros.description.yaml import write_yaml
from symofros.errors import EquilibriumError, SymofrosError, did_you_mean
from symofros.simulation.results.notes import distinct
from symofros.studio.editor.jobs.analyses import Analysed, equilibrium, linear, modes
from symofros.studio.editor.jobs.request import Json, Tell, number_of, numbers_for_json, table
from symofros.studio.editor.jobs.starts import laws_of, stated_start, whole_of

# Values of a parameter; records of each run.
MOST_VALUES, RECORDS = 21, 400
# Modes whose frequencies are drawn.
MOST_MODES = 8


def sweep(asked: Analysed, tell: Tell) -> Json:
    """Frequencies of the modes, or the motion, at several values of a run-time parameter."""
    name = str(asked.options.get("parameter"))
    names = asked.model.names.par
    if name not in names:
        rule = "a parameter of the model that is no constant, whose value is a number"
        raise SymofrosError(
            f"sweep: no parameter '{name:.50}'", ", ".join(names[:12]) or "none", rule, did_you_mean(name, names)
        )
    low, high = (number_of(asked.options.get(key), key) for key in ("low", "high"))
    values = np.linspace(low, high, whole_of(asked.options.get("count"), 2, MOST_VALUES, 5))
    swept = _frequencies if asked.options.get("of") == "frequencies" else _motions
    return swept(asked, tell, name, values)


def _at(asked: Analysed, name: str, value: float) -> None:
    """Let what is asked be about another value of a parameter; loops are closed anew there."""
    given = {**(asked.options.get("parameters") or {}), name: value}
    asked.start = stated_start(asked.model, {**asked.options, "parameters": given})


def _frequencies(asked: Analysed, tell: Tell, name: str, values: Array) -> Json:
    """Frequency of each mode over the parameter; where a value has no equilibrium, its curves break."""
    found: list[Array] = []
    said: list[tuple[str, str]] = []
    for i, value in enumerate(values.tolist()):
        label = f"{name} = {value:.4g}"
        tell(i, len(values), label)
        try:
            _at(asked, name, value)
            q, v, z, notes = asked.about()
            vibrations = sf.modes(asked.model, q, v, asked.u, par=asked.start.par, z=z)
            found.append(vibrations.frequencies / (2 * np.pi))
            said += ((label, note) for note in (*notes, *vibrations.notes))
        except (EquilibriumError, sf.BeamTheoryError) as error:
            found.append(np.zeros(0))
            said.append((label, f"{error.problem.what}; {error.problem.found}"))
    count = max(map(len, found))
    padded = np.array([[*each, *[np.nan] * (count - len(each))] for each in found]).reshape(len(values), count)
    curves = [
        {"name": f"mode {k + 1}", "x": values.tolist(), "y": numbers_for_json(padded[:, k])}
        for k in range(min(count, MOST_MODES))
    ]
    unit = asked.parameter_unit(name)
    head = [f"{name}{unit}", *(f"mode {k + 1} [Hz]" for k in range(count))]
    rows = [[f"{value:.6g}", *row] for value, row in zip(values.tolist(), padded.tolist(), strict=True)]
    plot = {"title": f"Frequencies over {name}", "x_title": f"{name}{unit}", "unit": "Hz", "curves": curves}
    return {
        "title": f"Frequencies |s|/2π at {len(values)} values of {name}",
        "tables": [table(f"Frequencies over {name}", head, rows)],
        "plots": [plot],
        "notes": _of_values(said),
        "beams": [],
    }


def _of_values(said: list[tuple[str, str]]) -> list[str]:
    """Notes with the first value that each is about; those that differ in numbers alone are one."""
    of: dict[str, list[str]] = {}
    for label, note in said:
        first = next((each for each in of if len(distinct((each, note))) == 1), note)
        of.setdefault(first, []).append(label)
    return [
        f"{labels[0]}{f' and {len(labels) - 1} more' if len(labels) > 1 else ''}: {note}" for note, labels in of.items()
    ]


def _motions(asked: Analysed, tell: Tell, name: str, values: Array) -> Json:
    """The motion at each value: curves of the signals that were chosen, and each motion in three dimensions."""
    options, model = asked.options, asked.model
    t_end = number_of(options.get("t_end", 1.0), "t_end")
    chosen: Json = {"method": options["method"]} if options.get("method") else {}
    chosen |= {key: number_of(options[key], key) for key in ("dt", "rtol") if options.get(key) is not None}
    laws, motions = laws_of(options.get("inputs")), {}
    said: list[tuple[str, str]] = []
    signals = {symbol_of(each): ("q", i) for i, each in enumerate(model.names.q)}
    signals |= {speed_column(each, model.names.q): ("v", i) for i, each in enumerate(model.names.v)}
    curves: dict[str, list[Json]] = {each: [] for each in signals}
    ends = []
    for i, value in enumerate(values.tolist()):
        tell(i, len(values), f"{name} = {value:.4g}")
        _at(asked, name, value)
        start, label = asked.start, f"{name} = {value:.4g}"
        run = sf.simulate(
            model, start.q, start.v, t_end, u=laws or None, par=start.par, output=t_end / RECORDS, **chosen
        )
        motions[label] = asked.motion(run.t, run.q, start.par)
        for signal, (kind, column) in signals.items():
            y = (run.q if kind == "q" else run.v)[:, column]
            curves[signal].append({"name": label, "x": numbers_for_json(run.t), "y": numbers_for_json(y)})
        ends.append([f"{value:.6g}", *run.q[-1].tolist(), "" if run.outcome.ok else run.outcome.reason])
        said += ((label, note) for note in run.outcome.notes)
    units = [asked.units.get(each, "") for each in model.names.q]
    plots = [
        {"title": signal, "x_title": "t [s]", "unit": units[column] if kind == "q" else "", "curves": curves[signal]}
        for signal, (kind, column) in signals.items()
    ]
    head = [f"{name}{asked.parameter_unit(name)}", *(f"{each}{asked.unit(each)}" for each in model.names.q), "ended by"]
    return {
        "title": f"Motions of {t_end:g} s at {len(values)} values of {name}",
        "tables": [table("Coordinates at the end", head, ends)],
        "plots": plots,
        "motions": motions,
        "notes": _of_values(said),
        "beams": [],
    }


def advise(asked: Analysed, tell: Tell) -> Json:
    """What may be left out of the model for a scene, each reduction verified by simulation."""
    options = asked.options
    outputs = tuple(_output(each) for each in options.get("outputs") or ())
    scene = sf.Scene(
        t_end=number_of(options.get("t_end", 1.0), "t_end"),
        outputs=outputs,
        inputs=laws_of(options.get("inputs")),
        start={str(name): number_of(x, str(name)) for name, x in (options.get("q0") or {}).items()}
        | {rate_symbol(str(name)): number_of(x, str(name)) for name, x in (options.get("v0") or {}).items()},
    )
    tell(0, 0, "simulating reduced models; this takes from seconds to minutes")
    advice = sf.advise(asked.system, scene)
    head = ["Part", "Change", "Verdict", "Estimated error", "Simulated error", "Why"]
    rows = [
        [each.subject, each.change, each.verdict, each.estimate, "" if each.error is None else each.error, each.why]
        for each in advice.choices
    ]
    reached = [[name, share * advice.bounds[name], advice.bounds[name]] for name, share in advice.errors.items()]
    return {
        "title": advice.summary()[-1],
        "tables": [
            table("Reductions, with errors in units of what is allowed", head, rows),
            table("Outputs of the reduced model", ["Output", "Error", "Allowed"], reached),
        ],
        "model": {"name": f"{asked.system.name}_reduced.yaml", "text": write_yaml(advice.system)},
        "notes": [advice.summary()[0], *advice.notes],
        "beams": [],
    }


def _output(given: Any) -> sf.Output:
    """An output of interest: what it is, and its absolute tolerance."""
    stated = given if isinstance(given, dict) else {}
    of, kind = str(stated.get("of", "")), str(stated.get("kind", "position"))
    return sf.Output(f"{kind} of {of}", kind, of, absolute=number_of(stated.get("absolute"), f"tolerance of {of}"))  # type: ignore[arg-type]


def analyse(request: Json, tell: Tell) -> Json:
    """What was asked for about the model.

    Raises:
        SymofrosError: No such analysis, or it has no result here.
    """
    what = str(request.get("options", {}).get("what"))
    if what not in ANALYSES:
        raise SymofrosError(f"no analysis '{what:.50}'", what[:50], ", ".join(ANALYSES), did_you_mean(what, ANALYSES))
    return {
        "what": what,
        "plots": [],
        "motions": {},
        "start": None,
        "model": None,
        **ANALYSES[what](Analysed(request, tell), tell),
    }


ANALYSES: dict[str, Callable[[Analysed, Tell], Json]] = {
    "equilibrium": equilibrium,
    "modes": modes,
    "linear": linear,
    "sweep": sweep,
    "advise": advise,
}
