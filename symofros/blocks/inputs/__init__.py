"""Inputs: trajectories and signals that are known beforehand (section 6.1 of the paper)."""

from symofros.blocks.inputs.sequences import Sequence as Sequence
from symofros.blocks.inputs.square import Square as Square
from symofros.blocks.inputs.trajectories import CartesianTrajectory as CartesianTrajectory
from symofros.blocks.inputs.trajectories import JointTrajectory as JointTrajectory
from symofros.blocks.inputs.waves import Chirp as Chirp
from symofros.blocks.inputs.waves import Pulse as Pulse
from symofros.blocks.inputs.waves import Ramp as Ramp
from symofros.blocks.inputs.waves import Sine as Sine
from symofros.blocks.inputs.waves import Step as Step
