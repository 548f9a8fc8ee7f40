"""The studies of the report, in its order."""

from __future__ import annotations

from validation.diagrams import square, threads, two_arms
from validation.evidence.findings import Asked
from validation.questions.topic import Topic

STUDIES: dict[str, Asked] = {"square": square.study, "two_arms": two_arms.study, "threads": threads.study}

TOPIC = Topic(
    "diagrams",
    "Diagrams: a controlled flexible robot",
    "Run the paper's simulations from their block diagrams.",
    "docs/theory/diagrams.md",
    STUDIES,
)
