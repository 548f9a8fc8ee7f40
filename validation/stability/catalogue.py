"""The scenes of the atlas, in its order."""

from __future__ import annotations

from validation.stability.scene import Scene
from validation.stability.scenes import (
    baumgarte,
    beams,
    deflection,
    energy,
    euler_angles,
    families,
    light_bodies,
    long_loops,
    mass_ratio,
    redundant,
    singular,
    soft_closures,
    spin,
    stick_slip,
)

SCENES: dict[str, Scene] = {
    "baumgarte": baumgarte.SCENE,
    "singular": singular.SCENE,
    "soft_closures": soft_closures.SCENE,
    "long_loops": long_loops.SCENE,
    "redundant": redundant.SCENE,
    "stiff_beam": beams.SCENE,
    "damped_beam": beams.DAMPED_SCENE,
    "light_link": light_bodies.SCENE,
    "massless_cross": light_bodies.CROSS_SCENE,
    "mass_ratio": mass_ratio.SCENE,
    "stick_slip": stick_slip.SCENE,
    "energy": energy.SCENE,
    "euler_angles": euler_angles.SCENE,
    "spin": spin.SCENE,
    "shape_functions": families.SCENE,
    "deflection": deflection.SCENE,
}
