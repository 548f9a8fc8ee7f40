"""MEX without Matlab or Octave: its C, compiled with a stub of mex.h, answers as Python does, column by column."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import run
from tests.simulation.rigid_scenes import WITHOUT_ANSWER, three_feet

SAME = 1e-12
# Two motors on three joints: B is not symmetric; gravity across, so that little else is.
ARM = sf.System(
    "arm",
    tuple(
        sf.RigidBody(
            f"link{i}",
            sf.Joint(f"q{i}", "revolute", f"link{i - 1}" if i else "world", position=(0.5 * i, 0, 0), actuated=i < 2),
            sf.Inertia("m" if i else 1.0, (0.2, 0.1, 0), (0.1, 0.2, 0.2)),
            (sf.Frame(f"end{i}", (0.4, 0, 0.1)),),
        )
        for i in range(3)
    ),
    parameters=(sf.Parameter("m", 0.7),),
    gravity=(1.0, -9.0, 0.0),
)
# Arguments by their shapes and numbers; outputs as they lie in memory, one a line.
PROGRAM = Path(__file__).with_name("mex_ask.c").read_text()


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compiled(ARM, tmp_path_factory.mktemp("mex"))


def compiled(of: sf.System | sf.Diagram, folder: Path) -> Path:
    """A program that calls the function; the files of a diagram are compiled beside it."""
    files = [path.name for path in sf.export(of, "mex", folder, name="arm").files if path.suffix == ".c"]
    beside = (
        [name for name in files if name.startswith("arm_") and name != "arm_mex.c"]
        if isinstance(of, sf.Diagram)
        else []
    )
    shutil.copy(Path(__file__).parent / "mex_stub.h", folder / "mex.h")
    (folder / "main.c").write_text(PROGRAM)
    flags = ("-std=c99", "-O0", "-Wall", "-Wno-unused-function", "-I.")
    run("gcc", *flags, "main.c", *beside, "-lm", "-o", "ask", cwd=folder)
    return folder / "ask"


Argument = Sequence[float] | np.ndarray


def ask(program: Path, wanted: int, *arguments: Argument) -> subprocess.CompletedProcess[str]:
    """Call the function; a sequence is a column, an array of two axes what it is."""
    return ask_in_turn(program, (wanted, arguments))


def ask_in_turn(program: Path, *calls: tuple[int, Sequence[Argument]]) -> subprocess.CompletedProcess[str]:
    """Call the function so many times in one process."""
    lines = []
    for wanted, arguments in calls:
        arrays = [np.reshape(x, (len(x), 1)) if np.ndim(x) == 1 else np.atleast_2d(x) for x in arguments]
        words = [f"{x.shape[0]} {x.shape[1]} " + " ".join(map(repr, x.ravel(order="F").tolist())) for x in arrays]
        lines.append(f"{len(arrays)} {wanted} {' '.join(words)}")
    return subprocess.run([program], input="\n".join(lines), capture_output=True, text=True)


def answers(done: subprocess.CompletedProcess[str]) -> list[np.ndarray]:
    assert done.returncode == 0, done.stdout
    lines = [[float(word) for word in line.split()] for line in done.stdout.splitlines()]
    return [np.reshape(line[2:], (int(line[0]), int(line[1])), order="F") for line in lines]


def test_matrices_of_the_mex_function_match_python(program: Path, rng: np.random.Generator) -> None:
    model = sf.compile(ARM)
    (q, v, a), u = rng.normal(size=(3, 3)), rng.normal(size=2)
    x, par = np.concatenate([q, v]), [1.1]
    M, h, Q = model.dynamics(q, v, u, par=par)
    A, B = model.linearize(q, v, u, par=par)
    p, R = model.frame_pose("end1", q, par=par)
    frame = [p, R, model.frame_velocity("end1", q, v), model.frame_jacobian("end1", q)]
    frame.append(model.frame_jacobian_rate("end1", q, v))
    k = model.names.frames.index("end1") + 1.0
    cases = (
        ((1, x, u, par), [M, Q - h]),
        ((2, x, u, par), [model.forward_dynamics(q, v, u, par=par)]),
        ((3, x, a, [], par), [model.inverse_dynamics(q, v, a, par=par)]),
        ((4, x, [k], u, par), frame),
        ((7, x, u, par), [model.kinetic_energy(q, v, par=par), model.potential_energy(q, par=par)]),
        ((8, x, u, par), [A, B]),
    )
    for (flag, *arguments), wanted in cases:
        found = answers(ask(program, len(wanted), [float(flag)], *arguments))
        for one, other in zip(found, wanted, strict=True):
            other = np.asarray(other, dtype=np.float64)
            shape = other.shape if other.ndim == 2 else (other.size, 1)
            assert one.shape == shape, flag
            np.testing.assert_allclose(one, other.reshape(shape), rtol=SAME, atol=SAME * max(1.0, np.abs(other).max()))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([1.0], [0.0, np.nan, 0.0, 0.0, 0.0, 0.0]), ":value X = [q; v]; its entries are finite, and number 2 is not"),
        (([1.0], [0.0, 0.0, np.inf, 0.0, 0.0, 0.0]), ":value X = [q; v]"),
        (([1.0], np.zeros((1, 6))), ":shape X = [q; v]; it is a column of 6 doubles"),
        (([1.0], np.zeros((2, 3))), ":shape X = [q; v]"),
        (([1.0], np.zeros(6), np.zeros((1, 2))), ":shape U"),
        (([1.0], np.zeros(6), [np.nan, 0.0]), ":value U"),
        (([1.0], np.zeros(6), [], [np.nan]), ":value Parameters"),
        (([1.0], np.zeros(6), [], [-1.0]), ":parameters Parameters"),
        (([3.0], np.zeros(6), [0.0, np.nan, 0.0]), ":value A, the accelerations"),
        (([1.0], np.zeros(6), [], [], [np.inf]), ":value t"),
        (([1.0], np.zeros(3)), ":size X = [q; v]"),
        (([1.0], np.zeros(7)), ":size X = [q; v]"),
        (([1.0], np.zeros(6), [], np.ones((1, 2))), ":size Parameters; it is a real, full array of 1 doubles"),
        (([1.0], np.zeros(6), [], [], [0.0], [0.0]), ":inputs too many inputs"),
        (([11.0],), ":flag no such flag"),
        (([1.0],), ":missing X = [q; v]; it has 6 entries"),
        (([4.0], np.zeros(6), [99.0]), ":frame no such frame"),
        (([9.0], np.zeros(6), [], [], [0.0, 1.0, 0.0]), ":span"),
    ],
)
def test_invalid_states_inputs_and_parameters_are_refused(
    program: Path, arguments: tuple[Sequence[float], ...], words: str
) -> None:
    done = ask(program, 1, *arguments)
    assert done.returncode == 3 and words in done.stdout


def test_strikes_in_sequence_are_warned_of(tmp_path: Path) -> None:
    """Of a motion in which no simultaneous strike is found; without spin there is one."""
    asked, q = compiled(three_feet(), tmp_path), [0.0, 0, 0.1, 0, 0, 0, 1]
    for speeds, heard in ((WITHOUT_ANSWER, True), ((*WITHOUT_ANSWER[:3], 0, 0, 0), False)):
        done = ask(asked, 1, [9.0], [*q, *speeds], [0.0], [], [0.0, 0.01, 1e-3])
        assert done.returncode == 0 and ("symofros:sequence" in done.stdout) == heard, done.stdout[:200]
