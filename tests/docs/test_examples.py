"""Every script of examples/ runs, prints what its reader wants to see, and stays short."""

from __future__ import annotations

import re
import runpy
import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.late import needs_extra

EXAMPLES = Path(__file__).parents[2] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))

# What a script must print, beyond running to its end.
PRINTED = {
    "closed_loop": r"finished at t = 0\.5 s",
    "controller_diagram": r"tracking error \d\.\de-0[5-9]",
    "cross_check": r"(?s)mass_matrix +mujoco .*All \d+ comparisons on 1 model agree",
    "exchange": r"(?s)finished at t = 58 s.*release_spare +(0\.0e\+00|-?\d\.\de-[12]\d) J lost"
    r".*largest difference (0|\d[.\d]*e-[12]\d)",
    "first_arm": r"tip after 2 s",
    "flexible_beam": r"    3 +[5-7]\.\d+e-04",
    "fmu": r"differ by \d\.\de-1[4-9]",
    "gymnasium_environments": r"(?s)cart-pole: .* nothing to say.*robot: .* nothing to say.*tools at most 1?\d mm away",
    "inverse_kinematics": r"converged: True",
    "learned_residual": r"with it: [1-9]\d times nearer",
    "lqr": r"tilted by 0\.5 rad: .* 1\.2e-04 rad",
    "monte_carlo": r"2000 of 2000 came to their end",
    "mpc": r"then \d\.\d on average(?s:.)*cart at 0\.0\d\d m, pole tilted by 0\.0\d\d rad",
    "trajectory_optimisation": r"simulated: tool at most [0-9]\.\d mm from its path",
    "urdf_to_c": r"selftest 0",
}

PROGRAMS = {"exchange": ("cmake", "cc"), "urdf_to_c": ("cc",)}


# What README's own lines do in every run: a cross-check, and C from a URDF.
ELSEWHERE = {"cross_check", "urdf_to_c"}


@pytest.mark.parametrize(
    "script", [pytest.param(s, id=s.stem, marks=pytest.mark.slow if s.stem in ELSEWHERE else ()) for s in SCRIPTS]
)
def test_an_example_runs(script: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for program in PROGRAMS.get(script.stem, ()):
        if not shutil.which(program):
            pytest.skip(f"needs a program called {program}")
    extra = re.search(r"the extra `(\w+)`", script.read_text())
    if extra and find_spec(extra[1]) is None:
        pytest.skip(needs_extra(extra[1], extra[1]))
    runpy.run_path(str(script), run_name="__main__")
    assert re.search(PRINTED[script.stem], capsys.readouterr().out)


def test_examples_are_short_and_listed_in_the_readme() -> None:
    assert all(len(script.read_text().splitlines()) < 60 for script in SCRIPTS)
    listed = re.findall(r"\]\((\w+\.py)\)", (EXAMPLES / "README.md").read_text())
    assert sorted(listed) == [script.name for script in SCRIPTS]
    included = re.findall(r"\.\./examples/(\w+\.py)", (EXAMPLES.parent / "docs/examples.md").read_text())
    assert sorted(included) == [script.name for script in SCRIPTS]
