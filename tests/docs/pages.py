"""Pages of the documentation as the tests take them: their blocks of code, and what each block may need.

A comment before a block says what GitHub and the site do not show: `<!-- file: arm.yaml -->`, the block is that file
for what follows on the page; `<!-- part of bodies -->`, it belongs under that entry; `<!-- needs jax -->`, it runs
where that package is installed; `<!-- not run: reason -->`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Pages whose blocks of Python and YAML another test runs, because it asks more of them than to run.
ELSEWHERE = {
    "docs/blocks.md": "tests/blocks/test_docs.py",
    "docs/errors.md": "tests/test_errors_page.py",
    "docs/view.md": "tests/test_view_page.py",
}
# Languages that those tests run; a block of any other would be left out.
TAKEN = {
    "docs/blocks.md": {"python", "sh"},
    "docs/errors.md": {"python", "yaml", "xml", "text", "sh"},
    "docs/view.md": {"python", "sh"},
}
# Directives of the site; only cells hold code of their own, which building the site runs.
DIRECTIVES = {"code-cell", "eval-rst", "include", "literalinclude", "report-figure", "toctree"}
# Files that pages take for granted, of the repository.
CART_POLE = "reference_models/rigid/cart_pole.yaml"
GIVEN = {
    "docs/diagrams.md": {"arm.yaml": "reference_models/rigid/double_pendulum.yaml"},
    "docs/tour.md": {"arm.yaml": CART_POLE, "robot.urdf": "reference_models/arm.urdf"},
    "docs/view.md": {"arm.yaml": "reference_models/rigid/double_pendulum.yaml"},
    "docs/howto/fmu.md": {"arm.yaml": CART_POLE},
    "docs/howto/parameters.md": {"arm.yaml": CART_POLE},
    "docs/howto/real_time.md": {"arm.yaml": CART_POLE},
}
_BLOCK = re.compile(
    r"(?:^<!-- (?P<mark>[^\n]*) -->\n)?^```(?P<language>[^\n]*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True)
class Block:
    """One block of code.

    Attributes:
        page: Page, relative to the repository.
        line: Line of the page on which it begins.
        language: Language as the page states it.
        text: Code.
        mark: Remark in the comment before it, such as "file: arm.yaml"; "" for none.
    """

    page: str
    line: int
    language: str
    text: str
    mark: str

    @property
    def runs(self) -> bool:
        """Whether the page does not say why it can't."""
        return not self.mark.startswith("not run: ")

    def said(self, what: str) -> str:
        """What the remark says after "file: " or the like; "" if it says something else."""
        return self.mark.removeprefix(what) if self.mark.startswith(what) else ""


def blocks(page: str, language: str | None = None) -> list[Block]:
    """Blocks of a page, those of a language or all; directives of the site are none."""
    text = (ROOT / page).read_text(encoding="utf-8")
    all_blocks = [
        Block(page, text.count("\n", 0, match.start("text")), match["language"], match["text"], match["mark"] or "")
        for match in _BLOCK.finditer(text)
        if not match["language"].startswith("{")
    ]
    return [block for block in all_blocks if language in (None, block.language)]


def unseen(page: str) -> list[str]:
    """What a page fences that is neither a block nor a directive that is known: tests would leave it out."""
    text = (ROOT / page).read_text(encoding="utf-8")
    languages = [match["language"] for match in _BLOCK.finditer(text)]
    directives = {language.split("}")[0].strip("{") for language in languages if language.startswith("{")}
    fences = re.findall(r"^[ \t>]*(?:```|~~~).*$", text, re.MULTILINE)
    indented = [fence for fence in fences if not fence.startswith("```")]
    cells = [] if "tutorial/" in page else sorted(directives & {"code-cell"})
    open_ended = [f"{len(fences)} fences, {len(languages)} blocks"] * (len(fences) != 2 * len(languages))
    return [*indented, *open_ended, *sorted(directives - DIRECTIVES), *cells]


def pages() -> list[str]:
    """All pages that people read, relative to the repository."""
    listed = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("*.md"), ROOT / "examples/README.md", ROOT / "reports/README.md"]
    return sorted(path.relative_to(ROOT).as_posix() for path in listed)
