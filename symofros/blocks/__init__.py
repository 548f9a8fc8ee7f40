"""The library of blocks, by the categories of the paper's section 6."""

from symofros.blocks.controllers import ComputedTorque as ComputedTorque
from symofros.blocks.controllers import FrictionCompensation as FrictionCompensation
from symofros.blocks.controllers import GravityCompensation as GravityCompensation
from symofros.blocks.controllers import JointPD as JointPD
from symofros.blocks.dynamics import ForwardDynamics as ForwardDynamics
from symofros.blocks.dynamics import InverseDynamics as InverseDynamics
from symofros.blocks.generic import Constant as Constant
from symofros.blocks.generic import Gain as Gain
from symofros.blocks.generic import Hold as Hold
from symofros.blocks.generic import Join as Join
from symofros.blocks.generic import Pick as Pick
from symofros.blocks.generic import Product as Product
from symofros.blocks.generic import Sum as Sum
from symofros.blocks.generic import UnitDelay as UnitDelay
from symofros.blocks.inputs import CartesianTrajectory as CartesianTrajectory
from symofros.blocks.inputs import JointTrajectory as JointTrajectory
from symofros.blocks.inputs import Square as Square
from symofros.blocks.kinematics import Extremities as Extremities
from symofros.blocks.kinematics import ForwardKinematics as ForwardKinematics
from symofros.blocks.kinematics import InverseKinematics as InverseKinematics
from symofros.blocks.kinematics import Jacobian as Jacobian
