"""SYMOFROS: describe a mechanism, get its equations of motion as fast C code that is proved right.

import symofros as sf

system = sf.load("arm.yaml")           # native YAML or URDF
model = sf.compile(system)             # symbolic equations -> C -> callable
M = model.mass_matrix(model.neutral())
"""

from __future__ import annotations

import ast
from functools import cache
from importlib import import_module
from sys import modules
from typing import TYPE_CHECKING, Any

# The public names, each imported at its first use: so neither the import nor `symofros --help` waits for NumPy, cffi or
# the readers of files.
if TYPE_CHECKING:
    from symofros import interop as interop
    from symofros.base.events import Event as Event
    from symofros.base.options import Options as Options
    from symofros.compiler import compile_library as compile_library
    from symofros.compiler import compile_system
    from symofros.compiler import program_of as program_of
    from symofros.description import solids as solids
    from symofros.description.beams import sections as sections
    from symofros.description.beams.beam import Beam as Beam
    from symofros.description.beams.beam import BeamLoad as BeamLoad
    from symofros.description.beams.shapes import Samples as Samples
    from symofros.description.constraints import Closure as Closure
    from symofros.description.constraints import Constraint as Constraint
    from symofros.description.constraints import Coupling as Coupling
    from symofros.description.constraints import KnifeEdge as KnifeEdge
    from symofros.description.constraints import Nonholonomic as Nonholonomic
    from symofros.description.constraints import Rod as Rod
    from symofros.description.constraints import Rolling as Rolling
    from symofros.description.constraints import Switch as Switch
    from symofros.description.contacts import Contact as Contact
    from symofros.description.forces import Brake as Brake
    from symofros.description.forces import Connection as Connection
    from symofros.description.forces import Damper as Damper
    from symofros.description.forces import ForceState as ForceState
    from symofros.description.forces import Friction as Friction
    from symofros.description.forces import Hysteresis as Hysteresis
    from symofros.description.forces import Load as Load
    from symofros.description.forces import LuGre as LuGre
    from symofros.description.forces import Potential as Potential
    from symofros.description.forces import Rotor as Rotor
    from symofros.description.forces import Spring as Spring
    from symofros.description.forces import Stop as Stop
    from symofros.description.forces import VirtualPower as VirtualPower
    from symofros.description.frames import Frame as Frame
    from symofros.description.joints.joint import Joint as Joint
    from symofros.description.joints.joint import Limits as Limits
    from symofros.description.system import Body as Body
    from symofros.description.system import Inertia as Inertia
    from symofros.description.system import Input as Input
    from symofros.description.system import Parameter as Parameter
    from symofros.description.system import RigidBody as RigidBody
    from symofros.description.system import System as System
    from symofros.description.values import Rotation as Rotation
    from symofros.description.values import as_value
    from symofros.diagrams.batch import DiagramRuns as DiagramRuns
    from symofros.diagrams.conditional import Condition as Condition
    from symofros.diagrams.diagram import Diagram as Diagram
    from symofros.diagrams.files.reader import load_diagram as load_diagram
    from symofros.diagrams.files.writer import save_diagram as save_diagram
    from symofros.diagrams.linear import DiagramStateSpace as DiagramStateSpace
    from symofros.diagrams.result import DiagramRun as DiagramRun
    from symofros.diagrams.simulation import Simulation as Simulation
    from symofros.diagrams.stepper import DiagramStepper as DiagramStepper
    from symofros.errors import ActuationError as ActuationError
    from symofros.errors import ArgumentError as ArgumentError
    from symofros.errors import AssemblyError as AssemblyError
    from symofros.errors import BeamTheoryError as BeamTheoryError
    from symofros.errors import CompileError as CompileError
    from symofros.errors import CompilerMissingWarning as CompilerMissingWarning
    from symofros.errors import DescriptionError as DescriptionError
    from symofros.errors import EquilibriumError as EquilibriumError
    from symofros.errors import ExportError as ExportError
    from symofros.errors import InconsistentModelWarning as InconsistentModelWarning
    from symofros.errors import ParameterError as ParameterError
    from symofros.errors import Problem as Problem
    from symofros.errors import ShapeError as ShapeError
    from symofros.errors import SymofrosError as SymofrosError
    from symofros.errors import UnknownNameError as UnknownNameError
    from symofros.exports.equations.equations import ReadableEquations as ReadableEquations
    from symofros.exports.equations.equations import equations as equations
    from symofros.exports.exporting import export as export
    from symofros.expr.expression import Expression as Expression
    from symofros.expr.expression import evaluate as evaluate
    from symofros.loading import load as load
    from symofros.loading import save as save
    from symofros.runtime.model import Model as Model
    from symofros.simulation.analysis.actuator_efforts import actuator_efforts as actuator_efforts
    from symofros.simulation.analysis.base_parameters import base_parameters as base_parameters
    from symofros.simulation.analysis.equilibrium import equilibrium as equilibrium
    from symofros.simulation.analysis.kinematics.assembly import assemble as assemble
    from symofros.simulation.analysis.kinematics.inverse_batch import (
        inverse_kinematics_batch as inverse_kinematics_batch,
    )
    from symofros.simulation.analysis.kinematics.inverse_kinematics import Target as Target
    from symofros.simulation.analysis.kinematics.inverse_kinematics import inverse_kinematics as inverse_kinematics
    from symofros.simulation.analysis.kinematics.inverse_kinematics import joint_motion as joint_motion
    from symofros.simulation.analysis.modes import modes as modes
    from symofros.simulation.analysis.rollout import Rollout as Rollout
    from symofros.simulation.analysis.rollout import rollout as rollout
    from symofros.simulation.analysis.state_space import state_space as state_space
    from symofros.simulation.inputs import Signal as Signal
    from symofros.simulation.options import SimulationOptions as SimulationOptions
    from symofros.simulation.results.outcome import Outcome as Outcome
    from symofros.simulation.results.trajectories import Trajectories as Trajectories
    from symofros.simulation.results.trajectory import Trajectory as Trajectory
    from symofros.simulation.simulate import simulate as simulate
    from symofros.simulation.simulate_batch import simulate_batch as simulate_batch
    from symofros.simulation.stepper import Stepper as Stepper
    from symofros.simulation.steppers import Steppers as Steppers
    from symofros.studio.advice.advice import Advice as Advice
    from symofros.studio.advice.scene import Output as Output
    from symofros.studio.advice.scene import Scene as Scene
    from symofros.studio.advice.scene_file import load_scene as load_scene
    from symofros.studio.advice.search import advise as advise
    from symofros.studio.differences.diff import MechanismDiff as MechanismDiff
    from symofros.studio.differences.diff import diff as diff
    from symofros.studio.viewer.record import record as record
    from symofros.studio.viewer.view import view as view
    from symofros.studio.viewer.viewer import Viewer as Viewer

    compile = compile_system
    # The number or formula of a text or SymPy expression, as the constructors convert it.
    formula = as_value

__version__ = "0.1.0"


@cache
def _public() -> dict[str, tuple[str, str]]:
    """Public name -> its module and its name there, read from the imports above."""
    with open(__file__, encoding="utf-8") as source:
        block = next(node for node in ast.parse(source.read()).body if isinstance(node, ast.If))
    imported: dict[str, tuple[str, str]] = {}
    places: dict[str, tuple[str, str]] = {}
    for node in block.body:
        if isinstance(node, ast.ImportFrom):
            for name in node.names:
                (places if name.asname else imported)[name.name] = node.module or "", name.name
        elif (
            isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and isinstance(node.value, ast.Name)
        ):
            places[node.targets[0].id] = imported[node.value.id]
    return places


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name.startswith("__") or name not in _public():
        raise AttributeError(f"module 'symofros' has no attribute '{name}'")
    place, attribute = _public()[name]
    names = vars(import_module(place))
    value = names[attribute] if attribute in names else import_module(f"{place}.{attribute}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, those not loaded yet included, and modules."""
    return sorted({*_public(), *(name for name in globals() if f"{__name__}.{name}" in modules or name[:2] == "__")})
