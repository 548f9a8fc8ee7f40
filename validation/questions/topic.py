"""A report of questions: what it is about, and who answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from validation.evidence.findings import Asked


@dataclass(frozen=True)
class Topic:
    """One report.

    Attributes:
        name: Of the command and of the report's files.
        title: Its heading.
        help: Of the command, in a sentence.
        theory: The page of docs/ that it rests on.
        studies: Short name -> who answers, in the order of the page.
    """

    name: str
    title: str
    help: str
    theory: str
    studies: Mapping[str, Asked]
