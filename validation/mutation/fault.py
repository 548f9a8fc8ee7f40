"""One fault in one source file, and its identity."""

from __future__ import annotations

from dataclasses import dataclass

OPERATOR, SIGN, INDEX, FRAME = "operator", "sign", "index", "frame"
DROPPED, COMPARISON, CONSTANT, SWAPPED = "dropped term", "comparison", "constant", "swapped arguments"
KINDS = (OPERATOR, SIGN, INDEX, FRAME, DROPPED, COMPARISON, CONSTANT, SWAPPED)


@dataclass(frozen=True)
class SourceFault:
    """A piece of a file's text replaced by another.

    Attributes:
        module: Path of the file from the folder of the repository.
        line: Line, from 1.
        kind: One of KINDS.
        start: Offset of the piece in the text, in characters.
        before: The piece.
        after: What stands there instead.
    """

    module: str
    line: int
    kind: str
    start: int
    before: str
    after: str

    @property
    def id(self) -> str:
        """Identity: it stays the same as long as the line and its place do."""
        return f"{self.module}:{self.line}@{self.start}:{self.kind}:{_short(self.before)}->{_short(self.after)}"

    def planted(self, text: str) -> str:
        """The file's text with the fault.

        Raises:
            ValueError: The text is not the one that the fault was found in.
        """
        end = self.start + len(self.before)
        if text[self.start : end] != self.before:
            raise ValueError(f"{self.id}: the file has changed")
        return text[: self.start] + self.after + text[end:]


def _short(piece: str) -> str:
    return " ".join(piece.split())
