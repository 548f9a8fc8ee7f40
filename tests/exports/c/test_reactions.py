"""Reactions and efforts of actuators in C packages: what Python says of the same motion."""

from __future__ import annotations

import subprocess
from collections import ChainMap
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.exports.cases import packaged
from tests.models import compiled

PROGRAM = Template(Path(__file__).with_name("reactions.c.in").read_text())

# Two motors, each of which is an input.
DRIVEN = sf.System(
    "driven_arm",
    tuple(
        sf.RigidBody(
            f"link{i}",
            sf.Joint(f"q{i}", "revolute", "link0" if i else "world", position=(0.5 * i, 0, 0), actuated=True),
            sf.Inertia(1.0, (0.2, 0, 0), (0.1, 0.2, 0.2)),
        )
        for i in range(2)
    ),
)
SYSTEMS = ChainMap({"driven_arm": DRIVEN}, MODELS)  # Each is read when it is asked for.
# Models and the speeds whose joints have actuators: a tree, a loop with more actuators than freedoms, one in space with
# conditions that repeat each other, one with a prescribed motion and a beam.
CASES = {
    "double_pendulum": ("q1", "q2"),
    "driven_arm": ("q0", "q1"),
    "four_bar": ("q1", "q2", "q3"),
    "bricard": ("q1", "q3", "q4"),
    "spinning_beam": tuple(f"beam.bend_y[{i}]" for i in range(3)),
    "flexible_slider_crank": tuple(f"rod.bend_y[{i}]" for i in range(5)),
}
GUESSES = {
    "spinning_beam": [0.4, -0.2, 0.1],
    "four_bar": [1.2, -1.0, 1.3],
    "bricard": [0.1, -0.1, 0.1, -0.1, 0.1],
    "flexible_slider_crank": [-0.2, 0, 0, 0, 0, 0, 0.44],
}


def motions(model: sf.Model, name: str, count: int) -> list[tuple[np.ndarray, ...]]:
    """States and accelerations on the constraints: q, v, a, u."""
    made = []
    for seed in range(count):
        rng = np.random.default_rng(seed)
        u = model.record.u_default + 0.3 * rng.standard_normal(model.nu)
        guess = np.array(GUESSES.get(name, model.neutral())) + (
            0.0 if name in GUESSES else rng.standard_normal(model.nq)
        )
        v = 0.1 * rng.standard_normal(model.nv)
        if model.nc:
            state = sf.assemble(model, guess, v, u=u)
            guess, v = state.q, state.v
        made.append((guess, v, model.forward_dynamics(guess, v, u), u))
    return made


def numbers(line: str) -> np.ndarray:
    return np.array(list(map(float, line.split())))


def answered(folder: Path, name: str, actuators: str, states: Any, prescribed: str = "", **more: int) -> list[str]:
    """Lines that a package's program says of states; `more`: numbers of joints and of sections that it shows."""
    m = compiled(name) if name in MODELS else sf.compile(SYSTEMS[name])
    sizes = {"nq": m.nq, "nv": m.nv, "nu": m.nu, "nc": m.nc, "n": actuators.count(",") + 1, "joints": 0, "sections": 0}
    sizes |= {"states": len(states), **more}
    text = PROGRAM.substitute(name=name, actuators=actuators, prescribed=prescribed, **sizes)
    program = packaged(SYSTEMS[name], folder / "c", text, frames=[])
    given = " ".join(repr(float(x)) for state in states for part in state for x in part)
    return subprocess.run([program], input=given, capture_output=True, text=True, check=True).stdout.splitlines()


@pytest.mark.parametrize(
    "name",
    [
        "double_pendulum",
        "driven_arm",
        "four_bar",
        "spinning_beam",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("bricard", "flexible_slider_crank")),
    ],
)
def test_c_gives_the_reactions_of_python(tmp_path: Path, name: str) -> None:
    m, actuators = sf.compile(SYSTEMS[name]), CASES[name]
    states = motions(m, name, 3)
    if not m.nc:
        states = [(q, v, np.cos(np.arange(m.nv) + q[0]), u) for q, v, _, u in states]
    codes = ", ".join(
        str(m.names.u.index(actuator)) if actuator in m.names.u else f"SYM_ON_SPEED({m.names.v.index(actuator)})"
        for actuator in actuators
    )
    prescribed = 'call(sym_find(model, "prescribed_efforts", NULL));' if m.record.driven else ""
    if m.names.sections:
        prescribed += 'call(sym_find(model, "section_forces", NULL));'
    by_size, t = np.linspace(1.0, 2.0, len(actuators)), 0.25
    rows = [(*state, by_size, [t]) for state in states]
    shown = {"joints": len(m.names.joints), "sections": len(m.names.sections)}
    lines = iter(answered(tmp_path, name, codes, rows, prescribed, **shown))
    assert next(lines).split() == list(m.names.joints)
    for q, v, a, u in states:
        wanted = sf.actuator_efforts(m, q, v, a, actuators, u=u, sizes=by_size, t=t, beam_limit=1.0)
        assert int(next(lines)) == wanted.redundancy
        scale = 1e-9 * max(1.0, float(np.abs(wanted.efforts).max()))
        assert numbers(next(lines)) == pytest.approx(wanted.efforts, rel=1e-9, abs=scale)
        lam = numbers(next(lines))
        assert lam == pytest.approx(wanted.lam, rel=1e-8, abs=1e-8 * float(np.abs(wanted.lam).max(initial=1e-3)))
        wrenches = m.joint_wrenches(q, v, a, u, lam, t=t).ravel()
        assert numbers(next(lines)) == pytest.approx(wrenches, rel=1e-9, abs=1e-9 * float(np.abs(wrenches).max()))
        if m.record.driven:
            drives = m.prescribed_efforts(q, v, a, u, lam, t=t)
            assert numbers(next(lines)) == pytest.approx(drives, rel=1e-9)
        if m.names.sections:
            inside = m.section_forces(q, v, a, u, lam, t=t).ravel()
            assert numbers(next(lines)) == pytest.approx(inside, rel=1e-9, abs=1e-9 * float(np.abs(inside).max()))


def test_motions_that_actuators_cannot_produce_are_refused(tmp_path: Path) -> None:
    m = compiled("four_bar")
    state = sf.assemble(m, [1.2, -1.0, 1.3], [1.0, 0, 0], held=["q1"])
    a = m.forward_dynamics(state.q, state.v, np.zeros(m.nu))
    u = np.zeros(m.nu)
    cases = [
        (state.q, state.v, a, u, [1.0], [0.0]),
        (state.q + [0.01, 0, 0], state.v, a, u, [1.0], [0.0]),
        (state.q, state.v + [0.01, 0, 0], a, u, [1.0], [0.0]),
        (state.q, state.v, a + [0.01, 0, 0], u, [1.0], [0.0]),
    ]
    # One number a line, alone: what the call returned; -2 is SYM_EFFORTS_INCONSISTENT.
    answers = answered(tmp_path, "four_bar", "SYM_ON_SPEED(1)", cases)[1::4]
    assert [int(answer) for answer in answers] == [0, -2, -2, -2]


def test_an_actuator_named_twice_is_refused(tmp_path: Path) -> None:
    m = compiled("double_pendulum")
    row = [[0.1] * (m.nq + 2 * m.nv + m.nu), [1.0, 1.0], [0.0]]
    said = answered(tmp_path, "double_pendulum", "SYM_ON_SPEED(1), SYM_ON_SPEED(1)", [row])
    assert int(said[1]) == -1  # SYM_EFFORTS_UNKNOWN
