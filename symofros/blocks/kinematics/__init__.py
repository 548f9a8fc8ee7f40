"""Kinematics, direct and inverse (section 6.1 of the paper)."""

from symofros.blocks.kinematics.forward import Extremities as Extremities
from symofros.blocks.kinematics.forward import ForwardKinematics as ForwardKinematics
from symofros.blocks.kinematics.forward import Jacobian as Jacobian
from symofros.blocks.kinematics.inverse import InverseKinematics as InverseKinematics
