"""Inputs: trajectories and signals that are known beforehand (section 6.1 of the paper)."""

from symofros.blocks.inputs.square import Square as Square
from symofros.blocks.inputs.trajectories import CartesianTrajectory as CartesianTrajectory
from symofros.blocks.inputs.trajectories import JointTrajectory as JointTrajectory
