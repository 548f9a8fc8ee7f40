"""Words about a diagram that stand beside its blocks, as titles and remarks."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.diagrams.block import Block
from symofros.errors import DescriptionError

# Characters of a comment; what is longer belongs in a document.
MOST = 2000


@dataclass(frozen=True, kw_only=True)
class Comment(Block):
    """Words on the canvas: a title or a remark. It has no ports, and changes nothing of a run.

    Attributes:
        text: What it says; lines break where they do in the text.
        heading: Whether it stands in large letters, as the title of what is below it.
    """

    text: str
    heading: bool = False

    def __post_init__(self) -> None:
        """A comment is of bounded length and has no sample time."""
        if len(self.text) > MOST:
            raise DescriptionError(
                f"block '{self.name}': a comment that is too long",
                f"{len(self.text)} characters",
                f"at most {MOST} characters",
                "keep long texts in a document beside the diagram",
            )
        if self.period is not None or self.offset:
            raise DescriptionError(
                f"block '{self.name}': a comment has no samples",
                f"period {self.period}, offset {self.offset}",
                "a comment takes no part in a run",
                "drop period and offset",
            )
