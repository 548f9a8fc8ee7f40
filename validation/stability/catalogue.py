"""The studies of the atlas, in its order."""

from __future__ import annotations

from .closed_loops import baumgarte, long_loops, redundant, singular
from .contact import bounces, impact, incline, motions, strikes
from .flexible import beams
from .rigid import energy, euler_angles, light_bodies, mass_ratio, stick_slip
from .study import ParameterStudy

STUDIES: dict[str, ParameterStudy] = {
    "baumgarte": baumgarte.STUDY,
    "singular": singular.STUDY,
    "long_loops": long_loops.STUDY,
    "redundant": redundant.STUDY,
    "stiff_beam": beams.STUDY,
    "damped_beam": beams.DAMPED_STUDY,
    "light_link": light_bodies.STUDY,
    "massless_cross": light_bodies.CROSS_STUDY,
    "mass_ratio": mass_ratio.STUDY,
    "stick_slip": stick_slip.STUDY,
    "incline": incline.STUDY,
    "impact": impact.STUDY,
    "bounces": bounces.STUDY,
    "touching": motions.STUDY,
    "strikes": strikes.STUDY,
    "energy": energy.STUDY,
    "euler_angles": euler_angles.STUDY,
}

# Study that is gone -> what answers its question.
RETIRED = {
    "soft_closures": "stability --study singular",
    "spin": "accuracy --study spinning",
    "shape_functions": "accuracy --study conditioning",
    "deflection": "accuracy --study pendulum",
}
