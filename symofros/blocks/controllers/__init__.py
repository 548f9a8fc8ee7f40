"""Controllers (section 6.1 of the paper)."""

from symofros.blocks.controllers.compensation import FrictionCompensation as FrictionCompensation
from symofros.blocks.controllers.compensation import GravityCompensation as GravityCompensation
from symofros.blocks.controllers.computed_torque import ComputedTorque as ComputedTorque
from symofros.blocks.controllers.joint import JointPD as JointPD
