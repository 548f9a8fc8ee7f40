"""Description -> checked graph -> spanning tree -> coordinate indices."""

from __future__ import annotations

from symofros.mechanics.topology.beams import beam_mass as beam_mass
from symofros.mechanics.topology.conditions import Condition as Condition
from symofros.mechanics.topology.coordinates import coordinate_names as coordinate_names
from symofros.mechanics.topology.coordinates import coordinate_symbols as coordinate_symbols
from symofros.mechanics.topology.coordinates import joint_units as joint_units
from symofros.mechanics.topology.coordinates import motion_symbols as motion_symbols
from symofros.mechanics.topology.coordinates import speed_symbols as speed_symbols
from symofros.mechanics.topology.events import find_problems as find_problems
from symofros.mechanics.topology.frames import full_names as full_names
from symofros.mechanics.topology.frames import public_names as public_names
from symofros.mechanics.topology.numbers import Numbers as Numbers
from symofros.mechanics.topology.physics import OTHER_FUNCTIONS as OTHER_FUNCTIONS
from symofros.mechanics.topology.physics import moments_about_center as moments_about_center
from symofros.mechanics.topology.run_time import RunTimeCheck as RunTimeCheck
from symofros.mechanics.topology.tree import BASE as BASE
from symofros.mechanics.topology.tree import Link as Link
from symofros.mechanics.topology.tree import NamedFrame as NamedFrame
from symofros.mechanics.topology.tree import Placement as Placement
from symofros.mechanics.topology.tree import SpanningTree as SpanningTree
from symofros.mechanics.topology.tree import build_tree as build_tree
from symofros.mechanics.topology.tree import frame_of as frame_of
from symofros.mechanics.topology.units import unit_problems as unit_problems
