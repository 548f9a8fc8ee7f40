"""Events and modes in WebAssembly: rigid contacts, friction that sticks and actions move as in runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.exports.c.test_events import BALL, STRIKE
from tests.exports.c.test_rigid_contacts import SCENES, first
from tests.exports.cases import need, run

SLIDING = sf.System(
    "sliding",
    [
        sf.RigidBody(
            "block",
            sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=[sf.Spring(40.0), sf.Friction(2.0, sticks=True)]),
            sf.Inertia(1.5),
        )
    ],
)
CASES: dict[str, tuple[sf.System, dict[str, float], dict[str, Any], float]] = {
    "ball": (*SCENES["strikes at once"], {}, 1.0),
    "box": (*SCENES["box"], {}, 0.15),
    "rod, implicit": (*SCENES["rod"], {}, 0.5),
    "friction": (SLIDING, {"x": 0.4}, {}, 2.0),
    "actions": (BALL, {"z": 0.8}, STRIKE, 0.7),
}
MAIN = """import { load } from "./plan.mjs";
const [span, end] = process.argv.slice(2).map(Number), it = (await load()).instance();
for (let times = 0; times < 2; ++times) {
  it.reset();
  for (let k = 1; k * span < end + span / 2; ++k) it.advance(k * span);
}
console.log(...it.q, ...it.v);
"""


@pytest.mark.tools
@pytest.mark.parametrize("case", CASES)
def test_modules_move_as_runs_do(tmp_path: Path, case: str) -> None:
    """In calls of any length, and again after a reset."""
    need("node")
    system, start, events, t_end = CASES[case]
    options: dict[str, Any] = {"method": "rk4"}
    if "implicit" in case:
        options = {"method": "rodas4", "rtol": 1e-8, "atol": 1e-11}
    sf.export(system, "wasm", tmp_path / "wasm", name="plan", start=start, events=events or None, dt=1e-3, **options)
    (tmp_path / "wasm" / "main.mjs").write_text(MAIN)
    model = sf.compile(system)
    known = sf.simulate(model, *first(model, start), t_end=t_end, events=events or None, dt=1e-3, **options)
    assert len(known.events) > 1 or case == "actions"
    for span in (t_end / 10, t_end):
        printed = run("node", "main.mjs", repr(span), repr(t_end), cwd=tmp_path / "wasm").split()
        # Steps that adapt begin anew at each call.
        bound = 1e-7 if "implicit" in case and span < t_end else 1e-10
        assert np.array(printed, dtype=float) == pytest.approx([*known.q[-1], *known.v[-1]], abs=bound)
