"""States of forces in exports of code: the last speeds, the numbers of `sf.simulate` (docs/theory/states.md, (2))."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import need, run

_LUGRE = sf.LuGre(2.0, 3e3, 20.0, static=3.0, stribeck_velocity=0.05, viscous=0.3)
_BODY = sf.RigidBody(
    "b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(_LUGRE, sf.Hysteresis(80.0, 1.0), sf.Spring(200.0)),
                  actuated=True), sf.Inertia(1.5))  # fmt: skip
RUBBING = sf.System("rubbing", (_BODY,))
START = {"x": 0.1, "dx": 1.0, "x.bristle": 2e-4, "x.slip": -1e-3}
NOTE = (
    "states of forces are the last speeds, their rates the last accelerations, beside idle coordinates:"
    " x.bristle, x.slip"
)
STEP, END = 1e-4, 0.2
# By the same C under other flags, through a motion that sticks and slips.
SAME = 1e-10


@cache
def model() -> sf.Model:
    return sf.compile(RUBBING)


@cache
def end() -> np.ndarray:
    """q, v and z at the end by `sf.simulate`."""
    z0 = [START["x.bristle"], START["x.slip"]]
    run_ = sf.simulate(model(), [START["x"]], [START["dx"]], END, z0=z0, dt=STEP, u=[0.7], method="rk4")
    return np.concatenate([run_.q[-1], run_.v[-1], run_.z[-1]])


def of_carried(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """q, v and z of a state as exports have it; what else there is are integrals."""
    assert len(q) == len(v) == 3
    return np.concatenate([q[:1], v])


@cache
def state() -> tuple[np.ndarray, np.ndarray]:
    """q (3) and v (3) of a state with bristles bent."""
    return np.array([0.03, 0.4, -0.7]), np.array([0.02, 3e-4, 2e-3])


def wanted_rates() -> np.ndarray:
    """v', then z', at that state under 0.7 N."""
    q, v = state()
    given = (q[:1], v[:1], [0.7])
    return np.concatenate([model().forward_dynamics(*given, z=v[1:]), model().state_rates(*given, z=v[1:])])


@pytest.mark.parametrize("target", ["sfunction", "mex", "cuda"])
def test_exports_say_where_states_are(tmp_path: Path, target: str) -> None:
    """To a target they are speeds: what it does with those, its own tests hold."""
    started = {} if target == "cuda" else {"start": START}
    assert NOTE in sf.export(RUBBING, target, tmp_path, **started).notes
    assert target != "mex" or NOTE in (tmp_path / "rubbing.m").read_text()


@pytest.mark.tools
def test_octave_simulates_them(tmp_path: Path) -> None:
    need("octave-cli", "mkoctfile")
    sf.export(RUBBING, "mex", tmp_path, start=START, dt=STEP)
    code = (
        f"build_rubbing; [d, s] = rubbing(0); [T, X] = rubbing(9, s.X0, 0.7, [], [0 {END} {STEP}]);"
        " printf(' %.17g', d.nz, X(end, :)); printf(' %s', s.v_names{:});"
    )
    words = run("octave-cli", "-qf", "--eval", code, cwd=tmp_path).split()
    x = np.array(words[1:7], dtype=np.float64)
    assert words[0] == "2" and words[7:] == ["x", "x.bristle", "x.slip"]
    np.testing.assert_allclose(of_carried(x[:3], x[3:]), end(), rtol=0, atol=SAME)


@pytest.mark.tools
def test_a_module_of_webassembly_has_them(tmp_path: Path) -> None:
    """Names, rates and a motion under Node."""
    need("node")
    done = sf.export(RUBBING, "wasm", tmp_path, start=START, dt=STEP)
    assert NOTE in done.notes
    q, v = (x.tolist() for x in state())
    (tmp_path / "ask.mjs").write_text(f"""
import {{ load }} from "./rubbing.mjs";
const model = await load(), moving = model.instance();
const {{ a }} = model.evaluate("forward_dynamics", {{ q: {q}, v: {v}, u: [0.7] }});
moving.u[0] = 0.7;
for (let k = 1; k <= {round(END / STEP)}; ++k) moving.advance(k * {STEP}, {STEP});
console.log(JSON.stringify({{ z: model.names.z, nz: model.sizes.nz, a: [...a], q: [...moving.q], v: [...moving.v] }}));
""")
    found = json.loads(run("node", "ask.mjs", cwd=tmp_path))
    assert found["z"] == ["x.bristle", "x.slip"] and found["nz"] == 2
    np.testing.assert_allclose(found["a"], wanted_rates(), rtol=1e-12)
    np.testing.assert_allclose(of_carried(np.array(found["q"]), np.array(found["v"])), end(), rtol=0, atol=SAME)
    run("node", "selftest.mjs", cwd=tmp_path)
