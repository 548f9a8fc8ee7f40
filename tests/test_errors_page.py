"""docs/errors.md: each message on the page is the one that its snippet raises.

`python -m pytest tests/test_errors_page.py --update-golden` rewrites the messages.
"""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import symofros as sf

PAGE = Path(__file__).parent.parent / "docs" / "errors.md"
FILES = {"yaml": "arm.yaml", "xml": "arm.urdf"}

_ENTRY = re.compile(
    r"^## (?P<title>[^\n]+)\n\n```(?P<language>\w+)\n(?P<snippet>.*?)```\n\n```text\n(?P<message>.*?)```\n\n"
    r"(?P<remedy>(?:(?!^## ).)*)",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Example:
    """One error of the page: what makes it, what it says, what to do."""

    title: str
    language: str
    snippet: str
    message: str
    remedy: str


def examples() -> list[Example]:
    return [Example(**match.groupdict()) for match in _ENTRY.finditer(PAGE.read_text(encoding="utf-8"))]


def said(example: Example) -> str:
    """What the snippet raises, or prints if it raises nothing; files are in the current folder."""
    printed = io.StringIO()
    try:
        if example.language == "python":
            Path("arm.yaml").write_text(_ARM)
            with contextlib.redirect_stdout(printed):
                exec(compile(example.snippet, "snippet", "exec"), {"sf": sf, "np": np})
        else:
            Path(FILES[example.language]).write_text(example.snippet)
            sf.load(FILES[example.language])
    except (sf.SymofrosError, ValueError) as error:
        return f"{error}\n"
    return printed.getvalue()


# What snippets in Python load: the arm at the head of the page.
_ARM = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8").partition("\n## ")[0], re.DOTALL)[0]


@pytest.mark.parametrize("example", examples(), ids=lambda example: example.title)
def test_the_message_is_the_one_raised(
    example: Example, request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    message = said(example)
    if request.config.getoption("--update-golden"):
        page = PAGE.read_text(encoding="utf-8")
        head = f"## {example.title}\n\n```{example.language}\n{example.snippet}```\n\n```text\n"
        assert page.count(head) == 1
        page = page.replace(f"{head}{example.message}```", f"{head}{message}```")
        PAGE.write_text(page, encoding="utf-8")
    else:
        assert message == example.message
    assert "Traceback" not in message and str(tmp_path) not in message


@pytest.mark.parametrize("example", examples(), ids=lambda example: example.title)
def test_examples_of_errors_have_found_rule_and_remedy(example: Example) -> None:
    assert example.remedy.strip().endswith(".")
    if "  rule:" in example.message:
        problems = re.split(r"\n(?! )", example.message.strip())
        assert all(re.search(r"\n  found: .+\n  rule: .+\n  remedy: .+", problem) for problem in problems)
        # A fault of a file names the file.
        assert example.language == "python" or all(p.startswith(FILES[example.language]) for p in problems)
    else:
        assert "print(" in example.snippet  # Not an error: the page shows what comes out instead.


def test_every_example_of_the_page_is_tested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert len(examples()) == page.count("\n## ") >= 12
    assert page.count("```") == 2 + 4 * len(examples())  # One block at the head, two an entry.
    # The arm at its head is sound.
    (tmp_path / "arm.yaml").write_text(_ARM)
    assert sf.load(tmp_path / "arm.yaml").bodies
