"""The report on diagrams: its studies, in its order."""

from __future__ import annotations

from validation.diagrams import square, threads, two_arms
from validation.reporting.findings import Question
from validation.reporting.questions import composing, measuring
from validation.reporting.record import Topic

STUDIES: dict[str, Question] = {"square": square.study, "two_arms": two_arms.study, "threads": threads.study}

TOPIC = Topic(
    "diagrams",
    "Diagrams",
    "How does the paper's robot trace its square?",
    composing("Diagrams: a controlled flexible robot", "docs/theory/diagrams.md"),
    measuring(STUDIES, "Run the paper's simulations from their block diagrams."),
)
