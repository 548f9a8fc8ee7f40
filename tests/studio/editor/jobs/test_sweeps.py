"""Sweeps, advice, events of a run and chosen methods, as the page asks for them, against formulas of a pendulum."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from symofros.errors import SymofrosError
from symofros.studio.editor.jobs import operations
from symofros.studio.editor.jobs.sweeps import analyse
from tests.studio.editor.jobs.test_analyses import PENDULUM, G, L, analysed, rows


def run(kind: str, text: str = PENDULUM, **options: Any) -> dict[str, Any]:
    request = {"file": "model.yaml", "text": text, "options": options}
    result: dict[str, Any] = operations.TASKS[kind](request, lambda *_: None)
    return result


def test_frequencies_over_a_parameter_are_those_of_the_formula() -> None:
    """f = sqrt(g / l) / 2 pi at each length."""
    found = analysed(what="sweep", of="frequencies", parameter="l", low=0.2, high=0.6, count=3)
    (plot,) = found["plots"]
    (curve,) = plot["curves"]
    assert curve["x"] == pytest.approx([0.2, 0.4, 0.6]) and plot["unit"] == "Hz"
    assert curve["y"] == pytest.approx([math.sqrt(G / length) / (2 * math.pi) for length in curve["x"]])
    assert [row[0] for row in rows(found, "Frequencies").values()] == curve["y"]


def test_motions_over_a_parameter_are_curves_and_motions_of_their_own() -> None:
    """The heavier bob falls as the lighter one, and the longer one more slowly; each with the parameters it had."""
    options = {"what": "sweep", "of": "motion", "t_end": 0.3, "count": 2, "inputs": {"q": "0"}}
    heavy = analysed(parameter="m", low=0.5, high=2.0, **options)
    ends = [row[0] for row in rows(heavy, "Coordinates").values()]
    assert ends[0] == pytest.approx(ends[1]) and list(heavy["motions"]) == ["m = 0.5", "m = 2"]
    assert [motion["par"][1] for motion in heavy["motions"].values()] == [0.5, 2.0]
    long = analysed(parameter="l", low=L, high=2 * L, **options)
    angle = {plot["title"]: plot["curves"] for plot in long["plots"]}
    assert list(angle) == ["q", "dq"] and angle["q"][0]["y"][-1] > 1.5 * angle["q"][1]["y"][-1]
    # A first fall: q'' = g / l.
    speed, t = (np.array(angle["dq"][1][key]) for key in ("y", "x"))
    assert speed[5] == pytest.approx(G / (2 * L) * t[5], rel=1e-3)


def test_sweeps_need_run_time_parameters() -> None:
    for text in (PENDULUM, PENDULUM.replace("l: 0.4", "l: {value: 0.4, constant: true}")):
        with pytest.raises(SymofrosError, match="no parameter"):
            analysed(text, what="sweep", parameter="k" if text == PENDULUM else "l", low=1, high=2)


@pytest.mark.slow
def test_advice_is_given_with_a_model_that_can_be_opened() -> None:
    outputs = [{"kind": "coordinate", "of": "q", "absolute": 1e-3}]
    found = analysed(what="advise", t_end=0.5, outputs=outputs)
    assert rows(found, "Outputs")["coordinate of q"][1] == pytest.approx(1e-3)
    assert "constants" in str(rows(found, "Reductions")) and found["model"]["name"].endswith("_reduced.yaml")
    assert analysed(found["model"]["text"], what="equilibrium")["tables"]


def test_events_and_limits_end_a_run_where_they_are_met() -> None:
    """A fall from level: q = 1 rad is met at (dq)^2 = 2 g/l sin q; a limit ends the run."""
    stated = {"name": "one", "formula": "q - 1", "direction": "rising", "terminal": False}
    found = run("simulate", t_end=1.0, events=[stated], method="dop853", rtol=1e-10)
    ((name, t),) = found["events"]["rows"]
    series = {each["name"]: each["values"] for each in found["series"]}
    q, dq = (np.interp(t, found["t"], series[key]) for key in ("q", "dq"))
    assert (
        name == "one"
        and q == pytest.approx(1.0, abs=1e-5)
        and dq == pytest.approx(math.sqrt(2 * G / L * math.sin(1)), rel=1e-4)
    )
    assert found["t"][-1] == 1.0
    limited = PENDULUM.replace("actuated: true", "actuated: true, limits: {lower: -1, upper: 0.5}")
    ended = run("simulate", limited, t_end=1.0, stop_at_limits=True)
    assert ended["events"]["rows"][0][0] == "q at its largest, 0.5" and ended["t"][-1] < t
    assert run("simulate", limited, t_end=1.0)["events"]["rows"] == []
    for wrong in ([{**stated, "name": " "}], [stated, stated], [{**stated, "formula": ""}]):
        with pytest.raises(SymofrosError, match="event"):
            run("simulate", t_end=0.1, events=wrong)


def test_a_law_of_states_drives_an_input() -> None:
    """A torque that balances gravity holds the pendulum where it is released."""
    held = run("simulate", t_end=0.5, inputs={"q": "-m*9.81*l*cos(q)"}, q0={"q": 0.3})
    assert held["series"][0]["values"] == pytest.approx([0.3] * len(held["t"]), abs=1e-9)


def test_compiling_says_which_methods_were_chosen() -> None:
    table = run("compile")["methods"]
    assert table["head"][0] == "Function" and table["rows"]
    assert all(row[-1] and row[2] for row in table["rows"] if row[2] == "lanes")


def test_an_unknown_analysis_is_refused() -> None:
    with pytest.raises(SymofrosError, match="no analysis"):
        analyse({"file": "m.yaml", "text": PENDULUM, "options": {}}, lambda *_: None)
