"""SpanningTree, requests -> optimised Program: kinematics formed once, forward dynamics by the cheaper method."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

from symofros.base.functions import FUNCTIONS
from symofros.base.options import Options
from symofros.base.routes import ROUTES, Choice, choose, taken
from symofros.errors import DescriptionError, UnknownNameError, did_you_mean
from symofros.expr.garbage import without_collection
from symofros.expr.graph import Graph
from symofros.expr.program import Function, Output, Program
from symofros.generator.codegen.effort import effort
from symofros.generator.passes import run_passes
from symofros.mechanics.dynamics.constraints.rows import retracted
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.formulas import formula_program
from symofros.mechanics.dynamics.functions import Methods, Request, form_program
from symofros.mechanics.kinematics.links import tree_kinematics
from symofros.mechanics.topology.tree import SpanningTree, coupled_speeds
from symofros.mechanics.topology.user_formulas import stated_formulas

# What a C text or a library holds where the options name no functions.
_DEFAULT = (Request("dynamics"),)
_FORWARD, _ACCELERATION = Request("forward_dynamics"), "acceleration of trees"


class ProgramBuilder:
    """Optimised programs of one tree under one set of options.

    Each program is formed on a copy of the tree's kinematics: its text, and so the last bits of its results, depend on
    what it is asked for, and not on what was asked before.

    Args:
        tree: The mechanism, checked and numbered.
        options: `constraints` and `forward_dynamics` say how forward dynamics is formed.
    """

    def __init__(self, tree: SpanningTree, options: Options) -> None:
        self.tree, self._options = tree, options
        self._lock = threading.RLock()  # Functions of a model may be called, and so formed, from several threads.
        self._latest: tuple[tuple[Request, ...], Program] | None = None

    @cached_property
    def _kinematics(self) -> Equations:
        return Equations(self.tree)

    def equations(self) -> Equations:
        """Equations to form further functions on; only the kinematics are there."""
        with self._lock:
            return self._kinematics.fork()

    def program(self, requests: Sequence[Request]) -> Program:
        """The optimised program of some functions; the latest one is kept.

        Args:
            requests: Functions in order.

        Raises:
            DescriptionError: A function can't be formed, such as forward dynamics without inertia.
        """
        wanted = tuple(requests)
        with self._lock:
            if self._latest is None or self._latest[0] != wanted:
                self._latest = wanted, self._formed(wanted)
            return self._latest[1]

    @property
    def trees(self) -> Choice:
        """The route of the acceleration of a tree: as the options ask, or by count of operations."""
        if self.tree.system.constraints:
            return Methods().trees
        with self._lock:
            return self._counted[0]

    def formulas(self, function: str, frame: str = "") -> Program:
        """One function as it is formed, for a graph that takes its formulas over; all share a graph.

        Args:
            function: Name of the function.
            frame: Frame of a function of frames.
        """
        equations = self._taken_over
        methods = Methods(self.trees) if function == _FORWARD.name else Methods()
        return form_program(equations, [Request(function, frame)], methods)

    def of_formulas(self, formulas: Sequence[Any], reactions: bool) -> Program:
        """Formulas over the model's names as they are formed, for a graph that takes them over.

        Args:
            formulas: Numbers, texts or SymPy expressions.
            reactions: Whether they may use multipliers, wrenches and reactions, and are of a and lam then.
        """
        values = [(value, 0) for value in stated_formulas(self.tree, formulas, reactions)]
        return formula_program(self.equations(), values, derivatives=False)

    @cached_property
    def _taken_over(self) -> Equations:
        return self.equations()

    def retraction(self) -> Program:
        """The function q (+) step of the groups "q" and "step"."""
        kinematics = tree_kinematics(Graph(), self.tree)
        edges = tuple(retracted(kinematics))
        sizes = {"q": len(edges), "step": len(self.tree.coordinates.v)}
        function = Function("retraction", "", tuple(sizes), (Output("q", (len(edges),), edges),))
        return Program(self.tree.system.name, kinematics.g, sizes, (function,))

    @without_collection()
    def _formed(self, requests: tuple[Request, ...]) -> Program:
        if _FORWARD not in requests:
            return self._optimised(requests, Methods().trees)
        choice = self.trees
        counted = None if self.tree.system.constraints else self._counted[1]
        return counted if counted is not None and requests == (_FORWARD,) else self._optimised(requests, choice)

    @cached_property
    def _counted(self) -> tuple[Choice, Program | None]:
        """The route of the acceleration of a tree, and its program where several were counted."""
        programs: dict[str, Program] = {}

        def spent(method: str) -> float:
            programs[method] = self._optimised((_FORWARD,), taken(_ACCELERATION, method))
            return effort(programs[method], programs[method].functions[0])

        figures = {f"{method}_effort": partial(spent, method) for method in ROUTES[_ACCELERATION]}
        figures["coupled_speeds"] = partial(coupled_speeds, self.tree)
        asked = self._options.forward_dynamics.replace("auto", "")
        choice = choose(_ACCELERATION, self.equations().route_figures | figures, asked)
        program = programs.get(choice.method)
        if program is None:
            return choice, None
        return choice, replace(program, functions=(replace(program.functions[0], choices=(choice,)),))

    def _optimised(self, requests: Sequence[Request], trees: Choice) -> Program:
        # Reverse mode, and derivatives of short trees, favour the factors: articulated bodies are asked for by name.
        asked = self._options.forward_dynamics
        under_constraints = self._options.constraints.replace("multipliers", "")
        slopes = "articulated" if asked == "articulated" else ""
        methods = Methods(trees, slopes, under_constraints, asked == "factors")
        return run_passes(form_program(self.equations(), requests, methods))


def requested(tree: SpanningTree, options: Options) -> tuple[Request, ...]:
    """The functions that options ask for.

    Raises:
        UnknownNameError: No such function or frame.
        DescriptionError: The options ask for nothing.
    """
    if options.functions is None:
        return _DEFAULT
    for name in options.functions:
        if name not in FUNCTIONS:
            raise UnknownNameError(
                f"options: no function '{name}'", name, "a function of the model", did_you_mean(name, FUNCTIONS)
            )
    frames = _frames(tree, options)
    rows = [FUNCTIONS[name] for name in options.functions]
    requests = [Request(row.name) for row in rows if not row.of_frame]
    requests += [Request(row.name, frame) for row in rows if row.of_frame for frame in frames]
    if not requests:
        raise DescriptionError(
            "options: nothing to generate",
            "no functions",
            "functions name at least one, and frames of it",
            "name some, or leave functions out",
        )
    return tuple(requests)


def _frames(tree: SpanningTree, options: Options) -> list[str]:
    """Public names of the frames that options name; all by default."""
    names = [frame.name for frame in tree.frames]
    if options.frames is None:
        return names
    for name in options.frames:
        if not any(name in (frame.name, frame.qualified) for frame in tree.frames):
            raise UnknownNameError(
                f"system '{tree.system.name}': no frame '{name}'",
                name,
                "frames are those of its bodies",
                did_you_mean(name, names),
            )
    return [tree.frame(name).name for name in options.frames]
