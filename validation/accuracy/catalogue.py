"""The studies of the report, in its order."""

from __future__ import annotations

from validation.accuracy import (
    buckling,
    conditioning,
    convergence,
    damping,
    elastica,
    energy,
    modes_needed,
    outboard,
    pendulum,
    princeton,
    spinning,
    spinup,
)
from validation.evidence.findings import Asked
from validation.questions.topic import Topic

STUDIES: dict[str, Asked] = {
    "spinning": spinning.study,
    "convergence": convergence.study,
    "modes_needed": modes_needed.study,
    "spinup": spinup.study,
    "outboard": outboard.study,
    "elastica": elastica.study,
    "princeton": princeton.study,
    "buckling": buckling.study,
    "pendulum": pendulum.study,
    "energy": energy.study,
    "damping": damping.study,
    "conditioning": conditioning.study,
}

TOPIC = Topic(
    "accuracy",
    "Accuracy of beams",
    "Measure beams against closed forms, tables and exact rods.",
    "docs/theory/beams.md",
    STUDIES,
)
