"""What tools that look inside the generator may use: a harness, a profiler.

Everything here is public beside `symofros` itself and `symofros.blocks`; all else inside the package may change without
notice. Each name has its reason:

| names | for |
|---|---|
| Graph, Edge, OPS, ADD, MUL, Program, Function, needed_nodes | programs whose nodes are replaced: planted faults |
| evaluate_edges, evaluate_precisely | programs evaluated without C, in doubles or in as many digits as wanted |
| count_program | operations of a program |
| Evaluators | one program state by state, by vectors, by the interpreter, against each other |
| DEFAULT_FLAGS, find_toolchain, cpu_identity | provenance of a measurement, builds of peers by the same compiler |
| cache_folder, create_cache_folder, is_intact, install | builds of peers in the folder that nobody else can write to |
| CODE_IDENTITY, source_digest | results that only the same code may continue: campaigns |
| METHODS | the table of integrators: which adapt their steps, which are implicit |
| fixed_step_loop | the C loop of an integrator, called without the recording around it: timing |
| Numbers, Precision, Strided, columns | batches as the C functions by vectors take them: timing |
| CudaModel, DeviceArray, Driver, KernelUsage, compile_cuda, present | kernels and copies on a graphics processor |
| states_per_second | the rate of a kernel there |
| write_atomically | files that a reader never sees half written |
| units_of | descriptions in other units: a relation that the harness asks for |
| stored_json, stored_lines, append_line, keep | what an earlier run left; damage counts as absent, with a warning |
| Visual, visual_mesh, read_motion, Session, Workspace | file readers of viewer and editor, for fuzzing |
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cached_property

import numpy as np

from symofros.base.options import Options
from symofros.base.stored import append_line as append_line
from symofros.base.stored import keep as keep
from symofros.base.stored import stored_json as stored_json
from symofros.base.stored import stored_lines as stored_lines
from symofros.base.stored import write_atomically as write_atomically
from symofros.compiler import Compilation
from symofros.description.entry_units import units_of as units_of
from symofros.description.system import System
from symofros.description.visual import Visual as Visual
from symofros.expr.edges import Edge as Edge
from symofros.expr.graph import Graph as Graph
from symofros.expr.numerics.evaluate import evaluate_edges as evaluate_edges
from symofros.expr.numerics.evaluate import needed_nodes as needed_nodes
from symofros.expr.numerics.precise import evaluate_precisely as evaluate_precisely
from symofros.expr.ops import ADD as ADD
from symofros.expr.ops import MUL as MUL
from symofros.expr.ops import OPS as OPS
from symofros.expr.program import Function as Function
from symofros.expr.program import Program as Program
from symofros.generator.passes.count import count_program as count_program
from symofros.runtime.build.cache import cache_folder as cache_folder
from symofros.runtime.build.cache import create_cache_folder as create_cache_folder
from symofros.runtime.build.cache import install as install
from symofros.runtime.build.cache import is_intact as is_intact
from symofros.runtime.build.identity import CODE_IDENTITY as CODE_IDENTITY
from symofros.runtime.build.identity import source_digest as source_digest
from symofros.runtime.build.toolchain import DEFAULT_FLAGS as DEFAULT_FLAGS
from symofros.runtime.build.toolchain import cpu_identity as cpu_identity
from symofros.runtime.build.toolchain import find_toolchain as find_toolchain
from symofros.runtime.calls.kernel import Precision as Precision
from symofros.runtime.calls.layout import Numbers as Numbers
from symofros.runtime.calls.layout import Strided as Strided
from symofros.runtime.calls.layout import columns as columns
from symofros.runtime.cuda.arrays import DeviceArray as DeviceArray
from symofros.runtime.cuda.cuda_model import CudaModel as CudaModel
from symofros.runtime.cuda.driver import Driver as Driver
from symofros.runtime.cuda.figures import present as present
from symofros.runtime.cuda.figures import states_per_second as states_per_second
from symofros.runtime.cuda.nvrtc import KernelUsage as KernelUsage
from symofros.runtime.cuda.nvrtc import compile_cuda as compile_cuda
from symofros.runtime.model import Model
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS as METHODS
from symofros.simulation.stepping.stepper import Stepper
from symofros.studio.editor.document.session import Session as Session
from symofros.studio.editor.document.workspace import Workspace as Workspace
from symofros.studio.viewer.drawing.visual_meshes import visual_mesh as visual_mesh
from symofros.studio.viewer.playing.motion import read_motion as read_motion


def fixed_step_loop(model: Model, method: str, dt: float, steps: int, t_end: float) -> Stepper:
    """The C loop of an integrator with fixed steps, its inputs zero: `start` it, then `advance` it.

    Args:
        model: Model that is integrated.
        method: Name of a row of METHODS.
        dt: Step [s].
        steps: Steps between records.
        t_end: Time that no advance passes [s].
    """
    settings = Settings.of(model, SimulationOptions(method, dt, every=steps), t_end)
    stepper = Stepper(model, settings.method, plan_inputs(model, None), [], np.asarray(model.parameter_values))
    settings.apply(stepper)
    return stepper


class Evaluators:
    """One program of a system evaluated in three ways, each made when it is first asked for.

    Args:
        system: System as the user stated it.
        options: Options: what to generate and how; large batches are evaluated as the ways have it.

    Raises:
        DescriptionError: The system can't be a mechanism.
        CompileError: There is no C compiler, or it failed.
    """

    def __init__(self, system: System, options: Options) -> None:
        self._compilation = Compilation(system, replace(options, batch="loop"))

    @cached_property
    def by_states(self) -> Model:
        """C that evaluates one state at a time, batches too."""
        return self._compilation.model()

    @cached_property
    def interpreted(self) -> Model:
        """The NumPy interpreter."""
        return self._compilation.interpreted_model()

    def by_vectors(self, functions: Collection[str]) -> Model:
        """C that evaluates several states of a batch at a time, of some of the functions."""
        return self._compilation.model_by_vectors(functions)
