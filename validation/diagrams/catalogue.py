"""The report on diagrams: its studies, in its order."""

from __future__ import annotations

from ..reporting.findings import Question
from ..reporting.questions import composing, measuring
from ..reporting.record import Topic
from . import square, threads, two_arms

STUDIES: dict[str, Question] = {"square": square.study, "two_arms": two_arms.study, "threads": threads.study}

TOPIC = Topic(
    "diagrams",
    "Diagrams",
    "How does the paper's robot trace its square?",
    composing("Diagrams: a controlled flexible robot", "docs/theory/diagrams.md"),
    measuring(STUDIES, "Run the paper's simulations from their block diagrams."),
    folder="diagrams",
)
