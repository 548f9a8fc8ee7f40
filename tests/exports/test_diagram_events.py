"""Programs of diagrams whose mechanisms have events that act, and friction that sticks: they do what the run does."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.diagrams.run.test_switching import CASES, diagram
from tests.exports.cases import driven

SIGNALS = ["plant.q", "plant.v"]


@pytest.mark.parametrize("case", CASES)
def test_a_program_does_the_actions_of_the_run(case: str, tmp_path: Path) -> None:
    """To rounding, by the shipped flags, at every record."""
    stated = CASES[case]
    of = diagram(stated)
    t = np.linspace(0.0, stated.t_end, 21)
    found = driven(of, tmp_path / "c", t[:, np.newaxis], method="rk4", dt=1e-3, outputs=SIGNALS)
    run = sf.Simulation(of).run(stated.t_end, method="rk4", dt=1e-3, record=stated.t_end / 20)
    assert run.events["plant"], "nothing acts"
    last = np.array([np.flatnonzero(run.t <= at + 1e-12)[-1] for at in t])
    wanted = np.column_stack([run["plant.q"], run["plant.v"]])[last]
    assert np.abs(found - wanted).max() <= 1e-9 * max(1.0, np.abs(wanted).max())


def test_parameters_say_how_modes_begin(tmp_path: Path) -> None:
    """By the names of the model; what events set later is memory, which has no name."""
    stated = CASES["latch"]
    of, t = diagram(stated), np.linspace(0.0, stated.t_end, 11)
    found = driven(of, tmp_path / "c", t[:, np.newaxis], "m.shut", "0.0", method="rk4", dt=1e-3, outputs=SIGNALS)
    fell = sf.Simulation(of).run(stated.t_end, dt=1e-3, record=0.05, parameters={"m.shut": 0.0})
    assert not fell.events["plant"]
    np.testing.assert_allclose(found, np.column_stack([fell["plant.q"], fell["plant.v"]]), atol=1e-12)
    assert subprocess.run([tmp_path / "c" / "driven", "plant.shut", "0.0"], input="", text=True).returncode == 3
    with pytest.raises(sf.UnknownNameError, match=r"plant\.shut"):
        sf.Simulation(of).run(0.1, parameters={"plant.shut": 0.0})
