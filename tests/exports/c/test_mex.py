"""MEX in real Octave: the paper's calls as they are printed there, and the numbers of Python."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.c.test_events import BALL, STRIKE
from tests.exports.cases import SAMPLED, STARTS, STEP, first_state, need, run, system_of, trajectory

pytestmark = pytest.mark.tools
SAME = 1e-12
# Printed with all 17 digits, and computed by the same C under other flags: rounding of the last two.
LAST_DIGITS = 1e-14


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Builds models, each once in a folder of its own; the folder of them all."""
    need("octave-cli", "mkoctfile")
    home = tmp_path_factory.mktemp("mex")

    def build(*names: str) -> Path:
        for name in names:
            if not (home / name).is_dir():
                sf.export(system_of(name), "mex", home / name, start=STARTS[name], dt=STEP[name])
                run("octave-cli", "-qf", "--eval", f"build_{name}", cwd=home / name)
        return home

    return build


def octave(folder: Path, code: str) -> str:
    paths = "".join(f"addpath('{path}'); " for path in sorted(folder.iterdir()))
    return run("octave-cli", "-qf", "--eval", paths + code, cwd=folder)


def numbers(text: str) -> dict[str, np.ndarray]:
    """What `show` printed."""
    lines = [line.split() for line in text.splitlines()]
    return {words[0]: np.array(list(map(float, words[1:]))) for words in lines if words and words[0].isidentifier()}


SHOW = "function show(name, x), printf('%s', name); printf(' %.17g', x'); printf('\\n'); end\n"


@pytest.mark.parametrize("name", SAMPLED)
def test_the_calls_of_the_paper_match_the_model(built: Callable[..., Path], name: str) -> None:
    """Section 8.1, literally; `model` is the model's function."""
    code = (
        SHOW
        + f"model = @{name};\n"
        + """
[SysDim, SysSet, FlexLink, Parameter, Frame,
Info] = model(0);
X = SysSet.X0; U = 0.1 + SysSet.U0; Parameters = Parameter.values;
[Mnl, gnl] = model(1, X, U, Parameters);
show('M', Mnl); show('gnl', gnl); show('X', X); show('U', U);
""".replace("Frame,\nInfo", "Frame, ...\nInfo")
    )
    found = numbers(octave(built(name), code))
    model = sf.compile(system_of(name))
    q, v = first_state(model, name)
    M, h, Q = model.dynamics(q, v, np.full(model.nu, 0.1))
    # The start of a loop is closed by another back end here and there: compare at the state that Octave has.
    assert np.abs(found["X"] - np.concatenate([q, v])).max() < SAME
    assert np.abs(found["M"] - M.ravel()).max() < LAST_DIGITS * np.abs(M).max()
    assert np.abs(found["gnl"] - (Q - h)).max() < LAST_DIGITS * max(1.0, np.abs(h).max())


@pytest.mark.parametrize("name", SAMPLED)
def test_a_simulation_by_the_mex_function_matches_the_trajectory(built: Callable[..., Path], name: str) -> None:
    code = (
        SHOW
        + f"""
[d, s] = {name}(0); [T, X] = {name}(9, s.X0, [], [], [0 0.2 {STEP[name]}]); show('T', T(end)); show('X', X(end, :));
"""
    )
    found, wanted = numbers(octave(built(name), code)), trajectory(name, 0.2)
    x = np.concatenate([wanted.q[-1], wanted.v[-1]])
    assert found["T"][0] == 0.2
    assert np.abs(found["X"] - x).max() < SAME * np.abs(x).max()


def test_every_other_flag_of_the_mex_function_matches_the_model(built: Callable[..., Path]) -> None:
    """Two models loaded at once, called in turn."""
    code = (
        SHOW
        + """
[d, s] = planar_robot(0); X = s.X0; [d4, s4] = four_bar(0); X4 = s4.X0;
[a, lam] = planar_robot(2, X, [1; 2; 3]); show('a', a);
[a4, lam4] = four_bar(2, X4); show('a4', a4); show('lam4', lam4);
show('tau', planar_robot(3, X, a));
[p, R, V, J, dJ] = planar_robot(4, X, 'tool'); show('p', p); show('R', R); show('V', V); show('J', J); show('dJ', dJ);
[phi, G, gamma] = four_bar(5, X4 + 0.1); show('phi', phi); show('G', G); show('gamma', gamma);
[rate, G6, gamma6] = four_bar(6, X4); show('none', size(G6));
[T, V] = four_bar(7, X4); show('energy', [T, V]);
[A, B] = planar_robot(8, X, [1; 2; 3]); show('A', A); show('B', B);
show('heavy', four_bar(1, X4, [], [2, 1])); show('light', four_bar(1, X4));
"""
    )
    found = numbers(octave(built("planar_robot", "four_bar"), code))
    model, bar = sf.compile(system_of("planar_robot")), sf.compile(system_of("four_bar"))
    (q, v), (q4, v4), u = first_state(model, "planar_robot"), first_state(bar, "four_bar"), [1.0, 2.0, 3.0]
    a = model.forward_dynamics(q, v, u)
    a4, lam4 = bar.forward_dynamics(q4, v4, [], multipliers=True)
    p, R = model.frame_pose("tool", q)
    A, B = model.linearize(q, v, u)
    wanted = {
        "a": a,
        "a4": a4,
        "lam4": lam4,
        "tau": model.inverse_dynamics(q, v, a),
        "p": p,
        "R": R,
        "V": model.frame_velocity("tool", q, v),
        "J": model.frame_jacobian("tool", q),
        "dJ": model.frame_jacobian_rate("tool", q, v),
        "phi": bar.constraint(q4 + 0.1),
        "G": bar.constraint_jacobian(q4 + 0.1),
        "gamma": bar.constraint_bias(q4 + 0.1, v4 + 0.1),
        "energy": np.array([bar.kinetic_energy(q4, v4), bar.potential_energy(q4)]),
        "A": A,
        "B": B,
        "heavy": 2 * bar.mass_matrix(q4),
        "light": bar.mass_matrix(q4),
        "none": np.array([0, 3]),
    }
    for key, value in wanted.items():
        value = np.asarray(value).ravel()
        assert np.abs(found[key] - value).max() < SAME * max(1.0, np.abs(value).max()), key


def test_events_act_in_the_simulation_of_the_mex_function(tmp_path: Path) -> None:
    """As in a run from Python, in each call from the start: modes and what counts once begin anew."""
    need("octave-cli", "mkoctfile")
    events = {**STRIKE, "thrown": sf.Event("t - 0.9", once=True, action={"dz": 1.0})}
    sf.export(BALL, "mex", tmp_path / "ball", name="ball", events=events, dt=1e-3)
    run("octave-cli", "-qf", "--eval", "build_ball", cwd=tmp_path / "ball")
    call = "[T, X] = ball(9, [0.8; 0], [], [], [0 1 1e-3]);"
    found = numbers(octave(tmp_path, SHOW + f"{call} {call}\nshow('T', T); show('X', X);"))
    run_ = sf.simulate(sf.compile(BALL), [0.8], t_end=1.0, events=events, dt=1e-3)
    assert [one.name for one in run_.events].count("thrown") == 1 and len(run_.events) > 2
    np.testing.assert_allclose(found["X"][-2:], [run_.q[-1, 0], run_.v[-1, 0]], atol=1e-12)
    with pytest.raises(sf.ExportError, match="ends the motion"):
        sf.export(BALL, "mex", tmp_path / "ends", events={"rest": sf.Event("t - 0.5", terminal=True)})


@pytest.mark.parametrize("name", ["eval", "sphere"])
def test_a_name_of_octaves_own_is_refused_where_it_is_built(name: str, tmp_path: Path) -> None:
    need("octave-cli", "mkoctfile")
    sf.export(system_of("pendulum"), "mex", tmp_path, name=name)
    done = subprocess.run(
        ["octave-cli", "-qf", "--eval", f"build_{name}"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode != 0
    assert f"{name} is a function already" in done.stderr
    assert f"my_{name}" in done.stderr
    assert not (tmp_path / f"{name}.mex").exists()
