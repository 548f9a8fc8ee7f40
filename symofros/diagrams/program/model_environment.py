"""The models of a diagram as blocks see them: sizes, first states, and functions written into a block's graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.functions import FRAME_FUNCTIONS, FUNCTIONS, OutputArray
from symofros.base.names import coordinate_of, speed_of
from symofros.base.options import Options
from symofros.compiler import Compilation, compile_system
from symofros.description import Friction, System
from symofros.diagrams.block import ModelSetup
from symofros.diagrams.program.variants import FRICTION, friction_only
from symofros.diagrams.tensor import Tensor, joined
from symofros.errors import DescriptionError, ParameterError, Problem, ShapeError, did_you_mean
from symofros.expr import Edge, Factors, Graph, Program, copy_into, needed_nodes
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord
from symofros.simulation.analysis.imbalance import imbalance
from symofros.simulation.analysis.kinematics.starts import closed_start, stated_names
from symofros.simulation.analysis.state_space import StateSpace, state_space


def parameter_group(model: str) -> str:
    """The input group of a model's run-time parameters in a block's graph; a name that C takes."""
    return "m_" + model.removesuffix(FRICTION).replace("/", "__")


class Models:
    """The models of one diagram.

    Args:
        diagram: Name of the diagram, for messages.
        setups: Name -> model.
    """

    def __init__(self, diagram: str, setups: Mapping[str, ModelSetup]) -> None:
        self._diagram = diagram
        self._setups = setups
        self._compilations: dict[str, Compilation] = {}
        self._models: dict[tuple[str, str, tuple[str, ...]], Model] = {}
        self._constraints: dict[str, Model] = {}
        self._linear: dict[str, Model] = {}
        self._records: dict[str, ModelRecord] = {}
        self._programs: dict[tuple[str, str, str], Program] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """All of them."""
        return tuple(self._setups)

    def setup(self, name: str) -> ModelSetup:
        """Setup of a model as it was stated; of NAME + FRICTION, that of the model with friction only.

        Raises:
            DescriptionError: There is none of that name.
        """
        if name.endswith(FRICTION):
            stated = self.setup(name.removesuffix(FRICTION))
            return replace(stated, system=friction_only(stated.system))
        if name not in self._setups:
            raise DescriptionError(
                f"diagram '{self._diagram}': no model '{name}'",
                f"'{name}'",
                f"models: {', '.join(self._setups) or 'none'}",
                did_you_mean(name, self._setups) or "add the model",
            )
        return self._setups[name]

    def system(self, name: str) -> System:
        """The description of a model."""
        return self.setup(name).system

    def compilation(self, name: str) -> Compilation:
        """A model's description, checked and numbered, and what can be formed of it."""
        if name not in self._compilations:
            self._compilations[name] = Compilation(self.system(name))
        return self._compilations[name]

    def record(self, name: str) -> ModelRecord:
        """Sizes and names of a model, as blocks see it: its states of forces apart."""
        if name not in self._records:
            self._records[name] = self.carried(name).without_states()
        return self._records[name]

    def carried(self, name: str) -> ModelRecord:
        """Sizes and names of a model, as it moves: states of forces last among its speeds, beside idle coordinates."""
        return self.compilation(name).record

    def parameters(self, name: str) -> Array:
        """The run-time parameters of a model (npar).

        Raises:
            DescriptionError: The model's description refuses those that the diagram states.
        """
        record = self.record(name)
        values = np.array(record.par_default, dtype=np.float64)
        for key, value in self.setup(name).parameters.items():
            values[self._index(name, "run-time parameter", key, record.par_names)] = float(value)
        problems = self._parameter_problems(name, values)
        if problems:
            raise DescriptionError(problems)
        return values

    def check_parameters(self, name: str, values: Array) -> None:
        """Refuse run-time parameters (npar) that the model's description does not allow.

        Raises:
            ParameterError: With the conditions that do not hold.
        """
        problems = self._parameter_problems(name, values)
        if problems:
            raise ParameterError(problems)

    def _parameter_problems(self, name: str, values: Array) -> list[Problem]:
        problems = self.compilation(name).parameter_problems(values[None])
        what = f"diagram '{self._diagram}': model '{name}'"
        return [replace(problem, what=f"{what}: {problem.what}") for problem in problems]

    def start(self, name: str) -> tuple[Array, Array]:
        """The first q and v of a model as it moves: with its states of forces and the idle coordinates."""
        record = self.carried(name)
        q, v = np.array(record.q_neutral, dtype=np.float64), np.zeros(len(record.v_names))
        for key, value in self.setup(name).start.items():
            if coordinate := coordinate_of(key, self.record(name).q_names):
                q[record.q_names.index(coordinate)] = value
            else:
                speed = speed_of(key, record.v_names) or key
                v[self._index(name, "coordinate or speed", speed, record.v_names)] = value
        return at_unit_length(record, "q", q, "the start"), v

    def own_start(self, name: str) -> tuple[Array, Array]:
        """The first q (nq) and v (nv) of a model, as blocks see it."""
        record, (q, v) = self.record(name), self.start(name)
        return q[: len(record.q_names)], v[: len(record.v_names)]

    def energies(self, name: str, options: Options) -> Model:
        """A model of a mechanism that has its energies only."""
        return self._chosen(name, options, "kinetic_energy", "potential_energy")

    def impacts(self, name: str, options: Options) -> Model:
        """A model of a mechanism that has what tells the impulses of impacts and their energies."""
        record = self.record(name)
        further = ("constraint_jacobian",) * bool(record.nc) + ("contact_forces",) * bool(record.rigid_contacts)
        return self._chosen(name, options, "kinetic_energy", "potential_energy", "mass_matrix", *further)

    def dynamics(self, name: str) -> Model:
        """A model of a mechanism that has its mass matrix and forces; interpreted, as `contacts`."""
        return self._chosen(name, Options(backend="interpreter"), "dynamics")

    def sections(self, name: str) -> Model:
        """A model of a mechanism that has the forces in its beams, and how they turn; interpreted, as `contacts`."""
        functions = "section_forces", "frame_pose", "frame_velocity", "mass_matrix"
        return self._chosen(name, Options(backend="interpreter"), *functions)

    def contacts(self, name: str) -> Model:
        """A model of a mechanism that has the forces of its contacts; interpreted, because a run asks for them once."""
        return self._chosen(name, Options(backend="interpreter"), "contact_forces")

    def _chosen(self, name: str, options: Options, *functions: str) -> Model:
        key = name, options.backend, functions
        if key not in self._models:
            self._models[key] = compile_system(self.system(name), replace(options, functions=functions)).carried
        return self._models[key]

    def constraints(self, name: str) -> Model:
        """A model of a mechanism that can close its loops; interpreted, because a start needs no compiler."""
        if name not in self._constraints:
            functions = "constraint", "constraint_rate", "constraint_jacobian", "frame_pose"
            self._constraints[name] = compile_system(
                self.system(name), Options(functions, backend="interpreter")
            ).carried
        return self._constraints[name]

    def linear(self, name: str, u: Array) -> StateSpace:
        """A model linearised about its first state and inputs u (nu), on its constraints, which are closed first.

        Raises:
            AssemblyError: The first state can't be brought onto the constraints.
        """
        model, q, v = self._about(name, u)
        return state_space(model, q, v, u, par=self.parameters(name))

    def imbalance(self, name: str, u: Array) -> tuple[str, float]:
        """The speed that changes most where `linear` linearises, and its acceleration; "" and 0 at a rest."""
        model, q, v = self._about(name, u)
        return imbalance(model, (q, v, u, np.zeros(0)), self.parameters(name), 0.0)

    def _about(self, name: str, u: Array) -> tuple[Model, Array, Array]:
        """A model, and its first state on its constraints; interpreted, since it is asked once."""
        if name not in self._linear:
            self._linear[name] = compile_system(self.system(name), Options(backend="interpreter"))
            self._linear[name].record.refuse_states(f"diagram '{self._diagram}': a linearised model")
        model, (q, v) = self._linear[name], self.start(name)
        stated = stated_names(model.names.q, model.names.v, self.setup(name).start)
        start = closed_start(model, q, v, *stated, u=u, par=self.parameters(name))
        return model, start.q, start.v

    def momentum(self, name: str) -> Array:
        """The momentum M v (nv) of a model at its first state."""
        model = compile_system(self.system(name), Options(("mass_matrix",), backend="interpreter"))
        q, v = self.own_start(name)
        return np.asarray(model.mass_matrix(q, par=self.parameters(name)) @ v)

    def _index(self, model: str, what: str, name: str, known: tuple[str, ...]) -> int:
        if name not in known:
            raise DescriptionError(
                f"diagram '{self._diagram}': model '{model}' has no {what} '{name}'",
                f"'{name}'",
                f"known: {', '.join(known[:12]) or 'none'}",
                did_you_mean(name, known) or "see model.names",
            )
        return known.index(name)

    def frame(self, model: str, frame: str) -> str:
        """The public name of a frame.

        Raises:
            DescriptionError: The model has no such frame.
        """
        record = self.record(model)
        public = record.frame_aliases.get(frame, frame)
        self._index(model, "frame", public, record.frame_names)
        return public

    def call(self, g: Graph, model: str, function: str, frame: str = "", **groups: Tensor) -> dict[str, Tensor]:
        """A model's function at a point of a graph; its parameters are the group `parameter_group`.

        Args:
            g: The graph.
            model: Name of the model.
            function: Function as of the methods of sf.Model.
            frame: Frame of frame functions.
            groups: q, v, a, u, t, gains, as the function takes them; t and u have defaults. Of a model whose forces
                have states: q, v and a of the mechanism beside z (nz), or with the states behind them, as it moves.

        Returns:
            Output -> values, with states behind them where q is given so; under constraints, "forward_dynamics" gives
            the terms M, r, G, c.

        Raises:
            DescriptionError: The function depends on states of forces, which are not given.
        """
        if function in FRAME_FUNCTIONS:
            frame = self.frame(model, frame)
        key = model, function, frame
        if key not in self._programs:
            self._programs[key] = self.compilation(model).programs.formulas(function, frame)
        program, record = self._programs[key], self.carried(model)
        stated = program.functions[0]
        entries = {output.name: Tensor.of(program.graph, output.edges, output.shape) for output in stated.outputs}
        if record.state_names and ("q" not in groups or groups["q"].size != len(record.q_names)):
            entries = {
                o.name: _own(record, o, entries[o.name]) for o in FUNCTIONS[function].outputs if o.name in entries
            }
            if "z" not in groups:
                self._refuse_unknown_states(model, function, program, entries)
            groups = _with_states(g, record, groups)
        replacement = self._bound(g, model, program, stated.inputs, groups)
        edges = copy_into(g, program.graph, [edge for one in entries.values() for edge in one.flat], replacement)
        outputs, at = {}, 0
        for name, one in entries.items():
            outputs[name] = Tensor.of(g, edges[at : at + one.size], one.shape)
            at += one.size
        return outputs

    def _refuse_unknown_states(
        self, model: str, function: str, program: Program, outputs: Mapping[str, Tensor]
    ) -> None:
        """Refuse a function that depends on states of forces, for a block that has none."""
        record, g = self.carried(model), program.graph
        wanted = [edge for one in outputs.values() for edge in one.flat]
        nodes = {abs(arg) for node in needed_nodes(g, wanted) for arg in g.args[node]} | set(map(abs, wanted))
        first = len(record.v_names) - len(record.state_names)
        slots = (g.slot[node] for node in nodes if node in g.slot)
        found = [record.v_names[slot.index] for slot in slots if slot.group == "v" and slot.index >= first]
        if found:
            rule = "a block that is given no z is of models whose forces have none"
            remedy = "connect its input z; where it has none, add the model once more without these elements, or use"
            remedy += " ModelFunction with z"
            what = f"diagram '{self._diagram}': {function} of model '{model}' depends on states of forces"
            raise DescriptionError(what, ", ".join(sorted(found)[:8]), rule, remedy)

    def formulas(self, g: Graph, model: str, formulas: Sequence[Any], reactions: bool, **groups: Tensor) -> Tensor:
        """Formulas over a model's names at a point of a graph (n).

        Args:
            g: The graph.
            model: Name of the model.
            formulas: Numbers and formulas, as `sf.Event` takes them.
            reactions: Whether they may use multipliers, wrenches and reactions.
            groups: q, v, u, t, a and lam.

        Raises:
            UnknownNameError: A formula uses a name that the mechanism lacks, or that it may not use.
        """
        program = self.compilation(model).programs.of_formulas(formulas, reactions)
        stated = program.functions[0]
        replacement = self._bound(g, model, program, stated.inputs, groups)
        return Tensor.of(g, copy_into(g, program.graph, stated.edges(), replacement), (len(formulas),))

    def solved(self, M: Tensor, r: Tensor) -> Tensor:
        """The x of M x = r for a mass matrix (nv, nv), whose zeros between branches are kept."""
        rows = [list(row) for row in M.edges]
        return Tensor.of(M.g, Factors(M.g, rows).solve(r.flat), r.shape)

    def has_elastic_beams(self, model: str) -> bool:
        """Whether a model has beams that bend or twist."""
        return any(link.tip_of is not None and link.tip_of.modes > 0 for link in self.compilation(model).tree.links)

    def has_friction(self, model: str) -> list[bool]:
        """Which speeds (nv) have friction."""
        rubs = [False] * len(self.record(model).v_names)
        for link in self.compilation(model).tree.links:
            for element in link.joint.elements:
                if isinstance(element, Friction):
                    rubs[link.v[0] + element.coordinate] = True
        return rubs

    def retract(self, g: Graph, model: str, q: Tensor, step: Tensor) -> Tensor:
        """The configuration q (+) step, for a step (nv) along the manifold."""
        program = self.compilation(model).programs.retraction()
        groups = {"q": q, "step": step}
        replacement = {
            program.graph.input(name, i): edge for name, values in groups.items() for i, edge in enumerate(values.flat)
        }
        return Tensor.of(g, copy_into(g, program.graph, program.functions[0].edges(), replacement), (q.size,))

    def _bound(
        self, g: Graph, model: str, program: Program, inputs: tuple[str, ...], groups: Mapping[str, Tensor]
    ) -> dict[Edge, Edge]:
        given = {"u": Tensor.numbers(g, self.record(model).u_default), **groups}
        replacement: dict[Edge, Edge] = {}
        for name in inputs:
            size = program.sizes[name]
            if name not in given or given[name].size != size:
                shape = given[name].shape if name in given else "nothing"
                raise ShapeError(
                    f"model '{model}': {name} of {program.functions[0].name}",
                    f"{shape}",
                    f"({size})",
                    "give it that shape",
                )
            replacement |= {program.graph.input(name, i): edge for i, edge in enumerate(given[name].flat)}
        own = {program.graph.input("par", i): g.input(parameter_group(model), i) for i in range(program.sizes["par"])}
        return replacement | own


def _own(record: ModelRecord, stated: OutputArray, values: Tensor) -> Tensor:
    """An output of a model with states of forces, without their rows and columns."""
    kept = [record.own_entries(size, n) for size, n in zip(stated.shape, values.shape, strict=True)]
    entries = [values[index] for index in product(*kept)]
    return Tensor.of(values.g, [edge for one in entries for edge in one.flat], tuple(map(len, kept)))


def _with_states(g: Graph, record: ModelRecord, groups: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Inputs of a mechanism beside z as those of the model that moves; idle coordinates and rates of states zero."""
    given = dict(groups)
    none = Tensor.numbers(g, np.zeros(len(record.state_names)))
    z = given.pop("z", none)
    given.setdefault("v", Tensor.numbers(g, np.zeros(len(record.v_names) - none.size)))
    for name, states in (("q", none), ("v", z), ("a", none)):
        if name in given:
            given[name] = joined([given[name], states])
    return given
