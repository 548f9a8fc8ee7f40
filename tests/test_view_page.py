"""docs/view.md: its examples run as they stand, and its pictures are there."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import reference_models
from tests.docs.pages import blocks

PAGE = Path(__file__).parent.parent / "docs" / "view.md"
ARM = Path(reference_models.__file__).parent / "rigid" / "double_pendulum.yaml"


@pytest.mark.slow
def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.chdir(tmp_path)
    shutil.copy(ARM, "arm.yaml")
    snippets = [block.text for block in blocks("docs/view.md", "python")]
    assert len(snippets) == 5
    names: dict[str, object] = {}
    for snippet in snippets:
        # Examples may run beside others: any free port in place of the usual one.
        exec(compile(snippet.replace("speed=0.5)", "speed=0.5, port=0)"), "view.md", "exec"), names)
    assert len(opened) == 2 and all(url.startswith("http://127.0.0.1:") for url in opened)
    written = {"square.png", "run.html", "run.gif", "last.png"}
    assert {path.name for path in tmp_path.iterdir()} == {"arm.yaml", *written}


def test_pictures_of_the_page_exist_and_are_small() -> None:
    named = re.findall(r"!\[[^]]+\]\((images/[^)]+)\)", PAGE.read_text())
    assert len(named) == 6
    assert all(10_000 < (PAGE.parent / name).stat().st_size < 120_000 for name in named)
