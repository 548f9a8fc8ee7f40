"""The library of blocks, by the categories of the paper's section 6."""

from symofros.blocks.controllers import JointPD as JointPD
from symofros.blocks.dynamics import ForwardDynamics as ForwardDynamics
from symofros.blocks.dynamics import InverseDynamics as InverseDynamics
