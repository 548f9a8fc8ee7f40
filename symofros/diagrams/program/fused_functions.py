"""All blocks in one graph: the functions that the compiled diagram consists of."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from symofros.diagrams.program.layout import Layout, Part
from symofros.diagrams.program.lowered_block import Piece, watched
from symofros.diagrams.program.model_environment import parameter_group
from symofros.diagrams.program.part_switching import owners_of
from symofros.diagrams.program.point import AFTER, AT, Point, reads
from symofros.diagrams.tensor import Tensor
from symofros.diagrams.wiring import Source, Wired
from symofros.expr import ONE, ZERO, Edge, Function, Graph, Output, Program, Solver, copy_into


class Fuser:
    """Writes a diagram's functions.

    Args:
        wired: The diagram.
        pieces: Blocks, lowered to expressions.
        layout: Layout of states and signals in memory.
        order: All outputs, each after what it depends on.
    """

    def __init__(self, wired: Wired, pieces: Mapping[str, Piece], layout: Layout, order: Sequence[Source]) -> None:
        self._wired, self._pieces, self._layout, self._order = wired, pieces, layout, order

    def _at(self, g: Graph, due: Iterable[str] = (), part: Part | None = None, after: bool = False) -> Point:
        return Point(self._wired, self._pieces, self._layout, self._order, g, frozenset(due), part, after)

    def _program(self, name: str, g: Graph, functions: Iterable[Function], part: Part | None = None) -> Program:
        layout, of = self._layout, part or self._layout.whole
        sizes = {
            "q": of.nq,
            "v": of.nv,
            "u": len(layout.u0),
            "t": 1,
            "par": len(layout.par),
            "a": of.nv,
            "lam": of.nc,
            "gains": 2 * of.nc,
            "step": of.nv,
        }
        return Program(name, g, sizes, tuple(functions))

    # Motion of a part.

    def motion(self, part: Part, *, whole: bool = True) -> Program:
        """A part's functions of its motion.

        They are forward_dynamics, project and constraint_jacobian where it has constraints, mass_matrix where it has
        elastic beams, "constraint" and "frame_pose" where events of mechanisms may engage some.

        Args:
            part: The part.
            whole: Whether "formulas", whose zeros are located, "actions" and "contact_state" are among them.
        """
        g = Graph()
        at = self._at(g, part=part)
        functions = self._constrained(at, part) if part.nc else self._free(at, part)
        for name in part.blocks:
            switching = self._pieces[name].switching
            for frame, pose in (switching.poses if switching is not None else {}).items():
                p, R = (at.write(self._pieces[name], value) for value in pose)
                outputs = _vector("p", p.flat), Output("R", (3, 3), tuple(R.flat))
                functions.append(Function("frame_pose", f"{name}.{frame}", ("q", "u", "t"), outputs))
        if whole:
            functions += [form(at, part) for form in self._located_forms(part).values()]
        return self._program(self._wired.name, g, functions, part)

    def located(self, part: Part) -> dict[str, Program]:
        """What locates and acts of a part, each as a program of its own: "events", "actions" and "contacts"."""
        programs: dict[str, Program] = {}
        for name, form in self._located_forms(part).items():
            g = Graph()
            programs[name] = self._program(self._wired.name, g, [form(self._at(g, part=part), part)], part)
        return programs

    def _located_forms(self, part: Part) -> dict[str, Callable[[Point, Part], Function]]:
        """What writes a part's functions of events: those that it has."""
        owners = owners_of(self._pieces, part)
        forms: dict[str, tuple[Callable[[Point, Part], Function], Any]] = {
            "events": (self._formulas, owners or watched(self._pieces)),
            "actions": (self._actions, owners),
            "contacts": (self._contacts, self._balls(part)),
        }
        return {name: form for name, (form, some) in forms.items() if some}

    def _balls(self, part: Part) -> list[tuple[Piece, Tensor]]:
        """Mechanisms with rigid contacts, and the states of their balls."""
        acting = [(self._pieces[name], self._pieces[name].switching) for name in part.blocks]
        return [(piece, switching.contacts) for piece, switching in acting if switching and switching.contacts.size]

    def _contacts(self, at: Point, part: Part) -> Function:
        """States of the balls of rigid contacts."""
        values = [edge for piece, states in self._balls(part) for edge in at.edges(piece, states.flat)]
        return Function("contact_state", "", AT, (_vector("value", values),))

    def _formulas(self, at: Point, part: Part) -> Function:
        """Values whose zeros are located: of crossings, then of events of mechanisms."""
        values = [
            edge
            for name, which in watched(self._pieces)
            for edge in at.edges(self._pieces[name], self._pieces[name].crossings[which].value.flat)
        ]
        after = self._at(at.g, part=part, after=True)  # C evaluates accelerations first, where they are read.
        own: dict[str, list[Edge]] = {}
        for name in part.blocks:
            switching = self._pieces[name].switching
            if switching is not None:
                own[name] = after.edges(self._pieces[name], switching.values.flat)
        values += [own[name][i] for name, i in owners_of(self._pieces, part)]
        inputs = AFTER if reads(at.g, values, ("a", "lam")) else AT
        return Function("formulas", "", inputs, (_vector("value", values),))

    def _actions(self, at: Point, part: Part) -> Function:
        """Values of the formulas of actions, as StatedActions orders them."""
        groups: tuple[list[Edge], ...] = ([], [], [])
        for name in part.blocks:
            piece = self._pieces[name]
            effects = piece.switching.groups_of_effects if piece.switching is not None else ()
            for into, formulas in zip(groups, effects, strict=False):
                into += at.edges(piece, formulas.flat)
        values = [edge for group in groups for edge in group]
        return Function("actions", "", AT, (_vector("value", values),))

    def _judging(self, at: Point, part: Part) -> list[Function]:
        """Functions mass_matrix and beam_stiffness of a part, by which its elastic beams are judged; none without."""
        nv, layout, models = part.nv, self._layout, self._wired.models
        M = [[ONE if i == k else ZERO for k in range(nv)] for i in range(nv)]
        K = [[ZERO] * nv for _ in range(nv)]
        lengths, stiffnesses = list[Edge](), list[list[Edge]]()
        for name in part.blocks:
            piece = self._pieces[name]
            if piece.terms.M is not None:
                model = piece.block.mechanism()
                first = layout.v[name].start - part.v.start
                for i, values in enumerate(at.write(piece, piece.terms.M).edges, first):
                    M[i][first : first + layout.v[name].size] = values
                if models.has_elastic_beams(model):
                    terms = self._of_parameters(at.g, model, "beam_stiffness")
                    lengths.extend(terms["L"].flat)
                    stiffnesses.extend(terms["EI"].edges)
                    for i, values in enumerate(terms["K"].edges, first):
                        K[i][first : first + layout.v[name].size] = values
        if not lengths:
            return []
        numbers = _vector("L", lengths), _matrix("EI", stiffnesses, 2), _matrix("K", K, nv)
        return [
            Function("mass_matrix", "", AT, (_matrix("M", M, nv),)),
            Function("beam_stiffness", "", (), numbers),
        ]

    def _of_parameters(self, g: Graph, model: str, function: str) -> dict[str, Tensor]:
        """A function of a model's run-time parameters alone, of the diagram's parameters."""
        own, place = Graph(), self._layout.parameters["", model]
        group = parameter_group(model)
        replacement = {own.input(group, i): g.input("par", place.start + i) for i in range(place.size)}
        outputs = self._wired.models.call(own, model, function)
        return {
            key: Tensor.of(g, copy_into(g, own, value.flat, replacement), value.shape) for key, value in outputs.items()
        }

    def _free(self, at: Point, part: Part) -> list[Function]:
        """Accelerations of mechanisms and rates of states, without constraints."""
        layout = self._layout
        a = [ZERO] * part.nv
        for name in part.blocks:
            piece = self._pieces[name]
            if piece.terms.a is not None:
                at_v = layout.v[name].start - part.v.start
                a[at_v : at_v + layout.v[name].size] = at.edges(piece, piece.terms.a.flat)
            for key, rate in at.write_all(piece, piece.rates).items():
                place = layout.states[name, key]
                at_v = place.start - part.v.start
                a[at_v : at_v + place.size] = rate.flat
        return [Function("forward_dynamics", "", AT, (_vector("a", a),)), *self._judging(at, part)]

    def _constrained(self, at: Point, part: Part) -> list[Function]:
        """M a = r + G^T lam, G a = c for the part as a whole: blocks on the diagonal, rows side by side."""
        nv, nc = part.nv, part.nc
        M = [[ZERO] * nv for _ in range(nv)]
        G = [[ZERO] * nv for _ in range(nc)]
        r, c, phi, rate = [ZERO] * nv, [ZERO] * nc, [ZERO] * nc, [ZERO] * nc
        layout, pieces, facing = self._layout, self._pieces, list[Edge]()
        for name in part.blocks:
            piece = pieces[name]
            if name in layout.v:
                first, n = layout.v[name].start - part.v.start, layout.v[name].size
                row = layout.lam[name].start - part.conditions.start
                terms = at.write_all(piece, piece.terms.stated())
                facing += terms["facing"].flat if "facing" in terms else ()
                if "a" in terms:
                    r[first : first + n] = terms["a"].flat
                    for k in range(first, first + n):
                        M[k][k] = ONE
                else:
                    r[first : first + n] = terms["r"].flat
                    for whole, key, at_row in ((M, "M", first), (G, "G", row)):
                        for i, values in enumerate(terms[key].edges):
                            whole[at_row + i][first : first + n] = values
                    for into, key in ((c, "c"), (phi, "phi"), (rate, "rate")):
                        into[row : row + piece.nc] = terms[key].flat
            for key, value in at.write_all(piece, piece.rates).items():
                for k, edge in enumerate(value.flat, layout.states[name, key].start - part.v.start):
                    M[k][k], r[k] = ONE, edge
        binds = [ZERO if edge == ZERO else ONE for edge in phi]
        measures = layout.measures_of(part)
        terms_of = (_matrix("M", M, nv), _vector("r", r), _matrix("G", G, nv), _vector("c", c))
        solved = (("a", (nv,)), ("lam", (nc,)), ("rank", ()))
        move = Function("move", "", ("q", "step"), (_vector("q_moved", self._moved(at, part)),))
        residuals = (_vector("binds", binds), _vector("phi", phi))
        solving = Solver("constrained", solved, (move,), measures)
        forward = Function("forward_dynamics", "", ("q", "v", "u", "gains", "t"), (*terms_of, *residuals), solving)
        shapes: dict[str, tuple[int, ...]] = {"q_on": (part.nq,), "v_on": (nv,), "residual": (), "rank": ()}
        projected = tuple((shapes | {"energies": (2,), "gap": ()}).items())
        faces = (_vector("facing", facing),) if facing else ()
        outputs = (terms_of[0], terms_of[2], *residuals, _vector("rate", rate), *faces)
        project = Function("project", "", AT, outputs, Solver("project", projected, (move,), measures))
        posture = AT if reads(at.g, terms_of[2].edges, ("v",)) else ("q", "u", "t")
        jacobian = Function("constraint_jacobian", "", posture, (terms_of[2],))
        functions = [forward, project, *self._judging(at, part), jacobian]
        if any(pieces[name].switching is not None for name in part.blocks):
            inputs = AT if reads(at.g, phi, ("v",)) else ("q", "u", "t")
            functions.append(Function("constraint", "", inputs, (_vector("phi", phi),)))
        return functions

    def _moved(self, at: Point, part: Part) -> list[Edge]:
        """The configuration that a step along the manifold leads to."""
        layout, rates = self._layout, [ZERO] * part.nq
        for name in part.blocks:
            if name in layout.q:
                q, v = layout.q[name], layout.v[name]
                model = self._pieces[name].block.mechanism()
                values = self._wired.models.retract(
                    at.g, model, at.input("q", q, part.q.start), at.input("step", v, part.v.start)
                )
                rates[q.start - part.q.start : q.start - part.q.start + q.size] = values.flat
        for segment in layout.segments:
            for i in range(segment.size if segment.kind == "linear" else 0):
                q_at, v_at = segment.q + i - part.q.start, segment.v + i - part.v.start
                if 0 <= q_at < len(rates) and rates[q_at] == ZERO:
                    rates[q_at] = at.g.add(at.g.input("q", q_at), at.g.input("step", v_at))
        return rates

    # Samples.

    def external(self, due: frozenset[str]) -> list[str]:
        """External blocks that are due, in the order in which they are called."""
        names = dict.fromkeys(name for name, _ in self._order if name in due)
        rest = dict.fromkeys(name for name in self._pieces if name in due)
        return [name for name in (names | rest) if self._pieces[name].is_external]

    def samples(self, sets: Sequence[frozenset[str]], listened: Sequence[Source] = ()) -> Program:
        """Functions at instants: "due_i" for each set, "crossed_i" for each crossing, "begun" at the start.

        "inputs_i_j" gives what the j-th block of set i is called with: its inputs, one after the other.
        """
        g = Graph()
        functions = [self._due(g, f"due_{i}", due) for i, due in enumerate(sets)]
        functions += [self._crossed(g, f"crossed_{i}", *which) for i, which in enumerate(watched(self._pieces))]
        if any(piece.begins for piece in self._pieces.values()):
            functions.append(self._begun(g))
        for i, due in enumerate(sets):
            functions += [
                self._gathered_inputs(g, f"inputs_{i}_{j}", name, due) for j, name in enumerate(self.external(due))
            ]
        if listened:
            functions.append(self._signals(g, listened))
        return self._program(self._wired.name, g, functions)

    def _due(self, g: Graph, name: str, due: frozenset[str]) -> Function:
        at = self._at(g, due, after=True)
        u = [g.input("u", i) for i in range(len(self._layout.u0))]
        for block in filter(due.__contains__, self._pieces):  # A set has no order of its own.
            piece = self._pieces[block]
            for port in piece.outputs:
                place = self._layout.held[block, port]
                u[place.slice] = at.signal((block, port)).flat
            for key, value in piece.updates.items():
                u[self._layout.memory[block, key].slice] = at.write(piece, value).flat
        return Function(name, "", AFTER, (_vector("u_next", u),))

    def _begun(self, g: Graph) -> Function:
        at = self._at(g, after=True)
        u = [g.input("u", i) for i in range(len(self._layout.u0))]
        for block, piece in self._pieces.items():
            for key, value in piece.begins.items():
                u[self._layout.memory[block, key].slice] = at.write(piece, value).flat
        return Function("begun", "", AFTER, (_vector("u_next", u),))

    def _crossed(self, g: Graph, name: str, block: str, which: str) -> Function:
        at, layout, piece = self._at(g, after=True), self._layout, self._pieces[block]
        u = [g.input("u", i) for i in range(len(layout.u0))]
        q = [g.input("q", i) for i in range(len(layout.q0))]
        v = [g.input("v", i) for i in range(len(layout.v0))]
        for key, value in piece.jumps[which].items():
            new = at.write(piece, value).flat
            if key in piece.memory:
                u[layout.memory[block, key].slice] = new
            elif key in piece.states:
                v[layout.states[block, key].slice] = new
            else:
                (q if key == "q" else v)[(layout.q if key == "q" else layout.v)[block].slice] = new
        return Function(name, "", AFTER, (_vector("u_next", u), _vector("q_next", q), _vector("v_next", v)))

    def _gathered_inputs(self, g: Graph, name: str, block: str, due: frozenset[str]) -> Function:
        at, memory = self._at(g, due, after=True), self._layout.memory
        edges = [
            edge
            for port in self._wired.ports[block].inputs
            if (source := self._wired.sources.get((block, port.name))) is not None
            for edge in (
                at.input("u", memory[block, port.name]) if (block, port.name) in memory else at.signal(source)
            ).flat
        ]
        return Function(name, "", AFTER, (_vector("inputs", edges),))

    def signals(self, sources: Sequence[Source]) -> Program:
        """The function "signals": some outputs, from what was recorded, one after the other."""
        g = Graph()
        return self._program(self._wired.name, g, [self._signals(g, sources)])

    def _signals(self, g: Graph, sources: Sequence[Source]) -> Function:
        at = self._at(g, after=True)
        return Function(
            "signals", "", AFTER, (_vector("y", [edge for one in sources for edge in at.signal(one).flat]),)
        )


def _vector(name: str, edges: Sequence[Edge]) -> Output:
    return Output(name, (len(edges),), tuple(edges))


def _matrix(name: str, rows: Sequence[Sequence[Edge]], columns: int) -> Output:
    return Output(name, (len(rows), columns), tuple(edge for row in rows for edge in row))
