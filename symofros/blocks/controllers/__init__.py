"""Controllers (section 6.1 of the paper)."""

from symofros.blocks.controllers.cartesian import CartesianFeedback as CartesianFeedback
from symofros.blocks.controllers.cartesian import CartesianLinear as CartesianLinear
from symofros.blocks.controllers.compensation import FrictionCompensation as FrictionCompensation
from symofros.blocks.controllers.compensation import GravityCompensation as GravityCompensation
from symofros.blocks.controllers.computed_torque import ComputedTorque as ComputedTorque
from symofros.blocks.controllers.joint import JointPD as JointPD
from symofros.blocks.controllers.joint import JointPID as JointPID
from symofros.blocks.controllers.lqr import LQR as LQR
