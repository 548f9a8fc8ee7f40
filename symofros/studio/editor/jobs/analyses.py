"""Analyses of a model about one state, in worker processes: equilibrium, modes, linear model."""

from __future__ import annotations

from typing import Any

import numpy as np

import symofros as sf
from symofros.base.arrays import Array
from symofros.base.names import speed_column, symbol_of
from symofros.compiler import compile_system
from symofros.mechanics.topology import build_tree
from symofros.simulation.analysis.equilibrium import Equilibrium
from symofros.studio.editor.jobs.bent_beams import bent_beams
from symofros.studio.editor.jobs.request import Json, Tell, numbers_for_json, system_of, table
from symofros.studio.editor.jobs.starts import StatedStart, stated_start, values_of
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.playing.signals import coordinate_units

# A mode is drawn at one turn a second, so that those of all frequencies can be watched.
CYCLES, STATES_A_CYCLE = 4, 24
# Modes that are drawn: of a large model the higher ones are in the table alone.
DRAWN = 24
# Columns of an eigenvalue s; share of |s| that is rounding.
EIGENVALUE = ["|s|/2π [Hz]", "|s| [rad/s]", "Damping ratio", "Re s [1/s]", "Im s [1/s]"]
ROUNDING = 1e-12
# Largest turn [rad] and largest displacement, as a share of the mechanism's size, of a mode as it is drawn.
TURN, SHARE = 0.4, 0.12


class Analysed:
    """What an analysis is about: the compiled model, the state that was stated, and the inputs."""

    def __init__(self, request: Json, tell: Tell) -> None:
        self.options: Json = request.get("options", {})
        tell(0, 3, "reading")
        self.system = system_of(request)
        tell(1, 3, "compiling")
        self.model = compile_system(self.system, sf.Options(background=True))
        self.start: StatedStart = stated_start(self.model, self.options)
        self.u = values_of(self.model.names.u, self.options.get("u"), np.zeros(self.model.nu), "input")
        self.units = coordinate_units(build_tree(self.system))
        tell(2, 3, "computing")

    @property
    def held(self) -> list[str]:
        """Names of the speeds whose coordinates stay."""
        return [str(name) for name in self.options.get("held") or ()]

    def unit(self, name: str) -> str:
        """Unit of a coordinate, in brackets; nothing where it has none."""
        unit = self.units.get(name, "")
        return f" [{unit}]" if unit else ""

    def parameter_unit(self, name: str) -> str:
        """Unit of a parameter, in brackets; nothing where it has none."""
        unit = next((each.unit for each in self.system.parameters if each.name == name), "")
        return f" [{unit}]" if unit else ""

    def motion(self, t: Array, q: Array, par: Array | None = None) -> Json:
        """States over time as a simulation returns them: t (n) [s], q (n, nq)."""
        names = self.model.names
        columns = [("q", symbol_of(name), self.units.get(name, ""), q[:, i]) for i, name in enumerate(names.q)]
        columns += [("u", name, "", np.full(len(t), self.u[i])) for i, name in enumerate(names.u)]
        return {
            "t": numbers_for_json(t),
            "series": [
                {"name": name, "kind": kind, "unit": unit, "values": numbers_for_json(values)}
                for kind, name, unit, values in columns
            ],
            "par": (self.start.par if par is None else par).tolist(),
        }

    def rest(self) -> Equilibrium:
        """The equilibrium that the stated state leads to."""
        start = self.start
        return sf.equilibrium(self.model, start.q, start.v, self.u, held=self.held, par=start.par)

    @property
    def where(self) -> str:
        """What is linearised about, in words."""
        return "the stated pose" if self.options.get("about") == "pose" else "the equilibrium"

    def about(self) -> tuple[Array, Array, Array, tuple[str, ...]]:
        """The state to linearise about: the equilibrium, or the stated one, q (nq), v (nv) and z (nz), and notes."""
        if self.options.get("about") == "pose":
            return self.start.q, self.start.v, np.zeros(self.model.nz), self.start.notes
        rest = self.rest()
        return rest.q, rest.v, rest.z, rest.notes

    def starts(self, q: Array) -> dict[str, float]:
        """Coordinates by name."""
        return dict(zip(self.model.names.q, q.tolist(), strict=True))


def equilibrium(asked: Analysed, tell: Tell) -> Json:
    """Where the model rests, and what holds it there."""
    rest, names = asked.rest(), asked.model.names
    q = _rounded(rest.q)
    tables = [
        table(
            "Coordinates",
            ["Coordinate", "At rest"],
            [[f"{name}{asked.unit(name)}", x] for name, x in zip(names.q, q.tolist(), strict=True)],
        )
    ]
    if len(rest.z):
        tables.append(
            table("States of forces", ["State", "At rest"], [*map(list, zip(names.z, rest.z.tolist(), strict=True))])
        )
    if rest.efforts:
        tables.append(
            table("Efforts on what is held [N m or N]", ["Speed", "Effort"], [*map(list, rest.efforts.items())])
        )
    if asked.held and rest.inputs:
        tables.append(table("Inputs that hold it by themselves", ["Input", "Value"], [*map(list, rest.inputs.items())]))
    if len(rest.lam):
        multipliers = zip(names.constraints, rest.lam.tolist(), strict=True)
        tables.append(table("Constraint forces [N or N m]", ["Condition", "Multiplier"], [*map(list, multipliers)]))
    unheld = ["no inputs hold this state by themselves"] if asked.held and rest.inputs is None else []
    return {
        "title": f"Equilibrium after {rest.iterations} steps, imbalance {rest.residual:.1g} of the largest force",
        "tables": tables,
        "motions": {"at rest": asked.motion(np.zeros(1), q[None])},
        "start": asked.starts(q),
        "notes": [*unheld, *asked.start.notes, *rest.notes],
        "beams": bent_beams(rest.bendings),
    }


def modes(asked: Analysed, tell: Tell) -> Json:
    """Small vibrations about the equilibrium, or about the stated state, each as a motion."""
    q, v, z, notes = asked.about()
    found = sf.modes(asked.model, q, v, asked.u, par=asked.start.par, z=z)
    s = found.eigenvalues
    rows = [[str(i + 1), *_eigenvalue(x), _largest(asked, found.shapes[:, i])] for i, x in enumerate(s)]
    head = ["Mode", *EIGENVALUE, "Largest in"]
    turns = np.linspace(0.0, CYCLES, CYCLES * STATES_A_CYCLE + 1)
    size = Mechanism(asked.system).drawing(asked.start.par).size
    motions = {}
    for i, shape in enumerate(found.shapes.T[:DRAWN]):
        swing = np.real(shape[None] * np.exp(2j * np.pi * turns)[:, None]) * _amplitude(asked, shape, size)
        label = f"mode {i + 1}, {found.frequencies[i] / (2 * np.pi):.4g} Hz"
        states = asked.model.integrate(np.repeat(q[None], len(turns), axis=0), swing)
        motions[label] = asked.motion(turns, np.asarray(states))
    count = "1 mode" if len(s) == 1 else f"{len(s)} modes"
    return {
        "title": f"{count} about {asked.where}; each is drawn at 1 Hz, undamped and enlarged",
        "tables": [table("Modes", head, rows)],
        "motions": motions,
        "start": asked.starts(q),
        "notes": list(dict.fromkeys([*notes, *found.notes])),
        "beams": bent_beams(found.bendings),
    }


def linear(asked: Analysed, tell: Tell) -> Json:
    """A and B of the linearised equations, and the eigenvalues of A."""
    q, v, z, notes = asked.about()
    model = asked.model
    found = sf.state_space(model, q, v, asked.u, par=asked.start.par, z=z)
    # The same equations: what is said of the modes is said of the eigenvalues. A and B are stated of any bending.
    vibrations = sf.modes(model, q, v, asked.u, par=asked.start.par, z=z, beam_limit=np.inf)
    n, names = len(found.A), model.names
    free = [*names.v, *(speed_column(name, names.q) for name in names.v), *names.z]
    states = free if n == len(free) else [f"xi{i + 1}" for i in range(n)]
    s = sorted(np.linalg.eigvals(found.A), key=lambda x: (abs(x), x.imag))
    eigenvalues = [[f"s{i + 1}", *_eigenvalue(x)] for i, x in enumerate(s)]
    reduced = n < len(free)
    return {
        "title": f"xi' = A xi + B u about {asked.where}: {n} states, {model.nu} inputs"
        + ("; xi are coordinates of what the constraints leave" if reduced else ""),
        "tables": [
            table("Eigenvalues of A", ["Eigenvalue", *EIGENVALUE], eigenvalues),
            table(
                "A", ["Rate of", *states], [[name, *row] for name, row in zip(states, found.A.tolist(), strict=True)]
            ),
            *(
                [
                    table(
                        "B",
                        ["Rate of", *names.u],
                        [[name, *row] for name, row in zip(states, found.B.tolist(), strict=True)],
                    )
                ]
                if model.nu
                else []
            ),
        ],
        "motions": {"state": asked.motion(np.zeros(1), q[None])},
        "start": asked.starts(q),
        "notes": list(dict.fromkeys([*notes, *vibrations.notes])),
        "beams": bent_beams(vibrations.bendings),
    }


def _rounded(q: Array) -> Array:
    """Coordinates (nq) without what Newton's method leaves of a zero."""
    return np.where(np.abs(q) < ROUNDING, 0.0, q)


def _eigenvalue(s: complex) -> list[float]:
    """The columns EIGENVALUE of s; a part that is rounding of the other is zero."""
    size = abs(s)
    real, imag = (0.0 if abs(part) < ROUNDING * size else part for part in (s.real, s.imag))
    return [size / (2 * np.pi), size, -real / size if real else 0.0, real, imag]


def _largest(asked: Analysed, shape: Any) -> str:
    """Name of the coordinate that moves most."""
    return asked.model.names.v[int(np.argmax(np.abs(shape)))] if len(shape) else ""


def _amplitude(asked: Analysed, shape: Any, size: float) -> float:
    """Factor of a shape with which no coordinate turns by more than TURN nor moves by more than SHARE of the size."""
    units = [asked.units.get(name, "") for name in asked.model.names.v]
    bounds = np.array([SHARE * size if unit.startswith("m") else TURN for unit in units])
    most = np.abs(shape) / bounds
    return 1.0 / float(most.max()) if most.max() > 0.0 else 0.0
