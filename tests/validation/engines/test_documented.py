"""docs/engines.md: the toy engine runs as a stranger's package, the conventions are those of now."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from tests.validation.engines.fakes import install_toy
from validation.engines.documented import PAGE, page

ROOT = Path(__file__).parents[3]


def test_a_strangers_engine_is_found_by_its_entry_point_and_judged(tmp_path: Path) -> None:
    use = install_toy(tmp_path)
    environment = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "PATH": ""}
    run = subprocess.run(
        [sys.executable, "-c", use], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    assert [line.split()[:2] for line in run.stdout.splitlines()] == [["mass_matrix", "wrong"], ["gravity", "right"]]
    assert run.stdout.split()[2] == "0.33"


def test_the_page_states_the_conventions_of_the_plug_ins() -> None:
    assert page(PAGE.read_text()) == PAGE.read_text()


def test_every_extra_that_an_engine_names_exists() -> None:
    from validation.engines.plugins import OWN

    stated = (ROOT / "pyproject.toml").read_text()
    named = [match for plugin in OWN.values() for match in re.findall(r"symofros\[([\w-]+)\]", plugin.extra)]
    assert named
    assert [extra for extra in named if f"\n{extra} = [" not in stated] == []
