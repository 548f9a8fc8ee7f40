"""States joint by joint, which stay what they are when links are dropped or an engine numbers joints anew."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..interface import Array, HasLayout, Slot, State, Tree, Unsupported
from ..plugins.writing.numbering import in_series

# Kind of joint -> our chart of it.
OURS = {
    "revolute": "angle",
    "prismatic": "length",
    "helical": "screw angle",
    "ball": "quaternion xyzw, body speeds",
    "free": "free xyzw, body speeds",
}


@dataclass(frozen=True)
class Layout:
    """How a model in another process keeps its joints (`interface.EngineModel`).

    Attributes:
        nq: Length of its q.
        nv: Length of its v.
        slots: Slots of the links' joints.
    """

    nq: int
    nv: int
    slots: tuple[tuple[Slot, ...], ...]

    @classmethod
    def ours(cls, tree: Tree) -> Layout:
        """Joints one after the other in the order of the links, in the charts of OURS."""
        slots, nq, nv = in_series(tree, {(kind, ""): chart for kind, chart in OURS.items()})
        return cls(nq, nv, slots)


@dataclass(frozen=True)
class Piece:
    """The part of a state that belongs to one joint (`interface.State`).

    Attributes:
        chart: Chart of the joint.
        q: Coordinates.
        q2: Further coordinates.
        v: Speeds.
        a: Rates of the speeds.
        tau: Forces.
        v2: Further speeds.
    """

    chart: str
    q: tuple[float, ...]
    q2: tuple[float, ...]
    v: tuple[float, ...]
    a: tuple[float, ...]
    tau: tuple[float, ...]
    v2: tuple[float, ...]


# For each link, the pieces of its joints, without those of kind "fixed".
Pieces = tuple[tuple[Piece, ...], ...]
RATES = ("v", "a", "tau", "v2")


def taken(layout: HasLayout, state: State) -> Pieces:
    """A state apart."""

    def part(values: Array, places: tuple[int, ...]) -> tuple[float, ...]:
        return tuple(float(values[place]) for place in places)

    return tuple(
        tuple(
            Piece(
                slot.chart,
                part(state.q, slot.q),
                part(state.q2, slot.q),
                *(part(getattr(state, name), slot.v) for name in RATES),
            )
            for slot in slots
        )
        for slots in layout.slots
    )


def assembled(layout: HasLayout, pieces: Pieces) -> State | Unsupported:
    """A state from its parts; joints that follow others come with these."""
    q, q2 = np.zeros(layout.nq), np.zeros(layout.nq)
    rates = {name: np.zeros(layout.nv) for name in RATES}
    own = [slot for slots in layout.slots for slot in slots]
    stated = [piece for link in pieces for piece in link]
    if len(own) != len(stated) or any(a.chart != b.chart for a, b in zip(own, stated, strict=True)):
        return Unsupported("the engine keeps the joints otherwise", offered=False)
    # The joint that others follow stands before them, so it is written last.
    for slot, piece in reversed(list(zip(own, stated, strict=True))):
        q[list(slot.q)], q2[list(slot.q)] = piece.q, piece.q2
        for name in RATES:
            rates[name][list(slot.v)] = getattr(piece, name)
    return State(q=q, q2=q2, **rates)
