"""The report on the accuracy of beams: its studies, in its order."""

from __future__ import annotations

from ..reporting.findings import Question
from ..reporting.questions import composing, measuring
from ..reporting.record import Topic
from .frequencies import conditioning, convergence, modes_needed, outboard, spinning
from .motion import damping, energy, pendulum, spinup
from .motion import rods as rods_in_motion
from .statics import buckling, elastica, estimate, princeton, rods

STUDIES: dict[str, Question] = {
    "spinning": spinning.study,
    "convergence": convergence.study,
    "modes_needed": modes_needed.study,
    "spinup": spinup.study,
    "outboard": outboard.study,
    "elastica": elastica.study,
    "princeton": princeton.study,
    "estimate": estimate.study,
    "buckling": buckling.study,
    "rods": rods.study,
    "rods_in_motion": rods_in_motion.study,
    "pendulum": pendulum.study,
    "energy": energy.study,
    "damping": damping.study,
    "conditioning": conditioning.study,
}

TOPIC = Topic(
    "accuracy",
    "Accuracy",
    "How accurate are beams?",
    composing("Accuracy of beams", "docs/theory/beams.md"),
    measuring(STUDIES, "Measure beams against closed forms, tables and exact rods."),
    folder="accuracy",
)
