"""The reports: what each answers, the command that writes it, and how it is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from validation.dashboard import correctness, models, speed
from validation.dashboard.card import Card


@dataclass(frozen=True)
class Topic:
    """One report.

    Attributes:
        group: Heading that it stands under.
        question: What it answers.
        command: Words after `python -m validation` that write it.
        read: Its JSON -> what is shown of it.
        everyday: Whether `--regenerate` writes it; one that takes other tools, or a plan of one's own, is left to hand.
    """

    group: str
    question: str
    command: tuple[str, ...]
    read: Callable[[Mapping[str, Any]], Card]
    everyday: bool = True


CAMPAIGN = ("campaign", "run", "--models", "all", "--report", "reports", "-o", "campaign")

# In the order of the page, and of `--regenerate`.
TOPICS: dict[str, Topic] = {
    "check": Topic("Correctness", "Do our C and independent engines agree?", (), correctness.check),
    "oracle": Topic("Correctness", "Do SymPy's derivations give the same digits?", ("oracle",), correctness.oracle),
    "mutation": Topic("Correctness", "Would the cross-check see a fault?", ("mutation",), correctness.mutation),
    "fuzz": Topic("Correctness", "Is every hostile file read, or refused in words?", ("fuzz",), correctness.fuzz),
    "campaign": Topic("Correctness", "And over a hundred thousand states?", CAMPAIGN, correctness.campaign, False),
    "accuracy": Topic("Accuracy", "How accurate are beams?", ("accuracy",), models.accuracy),
    "diagrams": Topic("Diagrams", "How does the paper's robot trace its square?", ("diagrams",), models.accuracy),
    "stability": Topic("Stability", "Where do simulations fail?", ("stability",), models.stability),
    "timing": Topic("Speed", "How fast is the C against engines and other generators?", ("timing",), speed.timing),
    "simulation": Topic("Speed", "How fast are motions at equal accuracy?", ("simulation",), speed.simulation),
    "rollouts": Topic("Speed", "How fast are thousands of motions at once?", ("rollouts",), speed.rollouts),
    "realtime": Topic("Speed", "How late do instants of diagrams begin?", ("realtime",), speed.realtime),
    "passes": Topic("Speed", "What does each pass of the generator gain?", ("passes",), models.passes),
    "exports": Topic("Speed", "What does a call cost, from where?", ("exports",), speed.exports),
    "pareto": Topic(
        "Accuracy against time", "Which model is the cheapest that is good enough?", ("pareto",), models.pareto
    ),
}
