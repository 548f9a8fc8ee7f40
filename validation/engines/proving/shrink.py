"""The smallest case that still shows a fault: links dropped, placements undone, numbers zeroed and rounded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from ..interface import IDENTITY, ORIGIN, End, Joint, Link, Rows, Tree, Vector
from ..models.files.formats import texts
from .pieces import Piece, Pieces

# Cases that are tried for one fault.
TRIES = 400
_PRINCIPAL = ((2.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, 4.0))
_UNITS: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# Turns by right angles, and one whose cosine and sine are short.
_TURNS: tuple[Rows, ...] = (
    ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
    ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)),
    ((0.6, -0.8, 0.0), (0.8, 0.6, 0.0), (0.0, 0.0, 1.0)),
)
# Engines' own gravity, which need not be said.
_DOWN: Vector = (0.0, 0.0, -9.81)


@dataclass(frozen=True)
class Case:
    """A tree and a state.

    Attributes:
        tree: The tree.
        pieces: The state.
        form: Format of the file that states the tree; "" for none.
        text: The file.
    """

    tree: Tree
    pieces: Pieces
    form: str = ""
    text: str = ""


def smallest(case: Case, shows: Callable[[Case], bool], most: int = TRIES) -> Case:
    """A case that shows a fault, of which no simpler neighbour does.

    Args:
        case: Case to begin with.
        shows: Whether a case shows the fault.
        most: Bound on the number of cases that are tried.
    """
    tried: set[Case] = set()
    place, moved, least = 0, False, size(case)
    while len(tried) < most:
        for number, candidate in enumerate(_simpler(case)):
            if number < place or candidate in tried or size(candidate) >= least:
                continue
            tried.add(candidate)
            if shows(candidate):
                # What came before was refused for the larger case: it comes again when the rest is through.
                case, least, place, moved = candidate, size(candidate), number, True
                break
            if len(tried) >= most:
                return case
        else:
            if not moved:
                return case
            place, moved = 0, False
    return case


def size(value: Any) -> int:
    """What a reader has to take in: zeros nothing, whole numbers little, others by their digits, links most."""
    if isinstance(value, float):
        return 0 if value == 0.0 else 1 if value == round(value) else len(repr(abs(value)))
    if isinstance(value, tuple):
        return sum(map(size, value))
    if is_dataclass(value):
        own = 100 if isinstance(value, Link) else 50 if isinstance(value, Joint) else 0
        own += 50 * len(value.features) if isinstance(value, Tree) else 0
        return own + sum(size(getattr(value, item.name)) for item in fields(value))
    return 0


def _simpler(case: Case) -> Iterator[Case]:
    if case.tree.asked and case.tree.features:
        for features in _fewer(case.tree.features):
            yield replace(case, tree=replace(case.tree, features=features))
        yield from _simpler_states(case)
        return
    if not case.form:
        yield from _simpler_built(case)
        return
    # A file that a tree was written to is written anew with the tree; of others the state alone is made simpler.
    if texts(case.tree).get(case.form) == case.text:
        for simpler in _simpler_built(case):
            written = texts(simpler.tree).get(case.form)
            if written:
                yield replace(simpler, form=case.form, text=written)
        return
    yield from _simpler_states(case)


def _fewer(features: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Features of a scene without one of its chains, or without one feature."""
    for number in dict.fromkeys(one.partition(": ")[0] for one in features if ": " in one):
        yield tuple(one for one in features if not one.startswith(f"{number}: "))
    for place in range(len(features)):
        yield features[:place] + features[place + 1 :]


def _simpler_built(case: Case) -> Iterator[Case]:
    yield from _without_links(case)
    yield from _all_at_once(case)
    yield from _without_joints(case)
    for tree in _plainer_trees(case.tree):
        yield replace(case, tree=tree)
    yield from _simpler_states(case)


def _simpler_states(case: Case) -> Iterator[Case]:
    for k, pieces in enumerate(case.pieces):
        for number, piece in enumerate(pieces):
            for simpler in _plainer_pieces(piece, bound=bool(case.tree.constraints)):
                yield replace(case, pieces=_with(case.pieces, k, _with(pieces, number, simpler)))


def _all_at_once(case: Case) -> Iterator[Case]:
    """Placements, inertias, axes and vectors of the state plain in all links together."""
    links = case.tree.links
    unplaced = tuple(
        replace(link, joints=tuple(replace(joint, R=IDENTITY, p=ORIGIN) for joint in link.joints)) for link in links
    )
    plain = tuple(replace(link, com=ORIGIN, inertia=IDENTITY, mass=1.0) for link in links)
    aligned = tuple(replace(link, joints=tuple(_about(joint, _UNITS[2]) for joint in link.joints)) for link in links)
    for chosen in (unplaced, plain, aligned):
        yield replace(case, tree=replace(case.tree, links=chosen))
    for names in (("v2", "tau"), ("a",), ("v",)):
        yield replace(case, pieces=tuple(tuple(_zeroed(piece, names) for piece in own) for own in case.pieces))
    yield replace(case, pieces=tuple(tuple(replace(piece, q2=piece.q) for piece in own) for own in case.pieces))


def _about(joint: Joint, axis: Vector) -> Joint:
    """A joint of one axis about another."""
    return replace(joint, axis=axis) if joint.kind in ("revolute", "prismatic", "helical") else joint


def _zeroed(piece: Piece, names: Sequence[str]) -> Piece:
    return _changed(piece, **{name: (0.0,) * len(piece.v) for name in names})


def _changed(piece: Piece, **vectors: tuple[float, ...]) -> Piece:
    return replace(piece, **vectors)  # type: ignore[arg-type]


def _with(items: Any, place: int, item: Any) -> Any:
    """A tuple with another item at a place."""
    return (*items[:place], item, *items[place + 1 :])


def _without_links(case: Case) -> Iterator[Case]:
    links = case.tree.links
    followed = {joint.mimics for link in links for joint in link.joints} | {case.tree.attached}
    followed |= {end.link for one in case.tree.constraints for end in one.ends}
    followed |= {end.link for one in case.tree.tendons for end in one.ends}
    followed |= {end.link for end in case.tree.sensors} | {one.link for one in case.tree.actuators}
    for gone in reversed(range(len(links))):
        if len(links) == 1 or links[gone].name in followed:
            continue
        heir = links[gone].parent
        kept = []
        for link in links[:gone] + links[gone + 1 :]:
            parent = heir if link.parent == gone else link.parent
            kept.append(replace(link, parent=parent - 1 if parent > gone else parent))
        pieces = case.pieces[:gone] + case.pieces[gone + 1 :]
        if any(pieces):
            yield Case(replace(case.tree, links=tuple(kept)), pieces)


def _without_joints(case: Case) -> Iterator[Case]:
    for k, link in enumerate(case.tree.links):
        moving = [number for number, joint in enumerate(link.joints) if joint.kind != "fixed"]
        for place, number in enumerate(moving):
            if len(moving) > 1 and not any(
                joint.mimics == link.name for own in case.tree.links for joint in own.joints
            ):
                joints = link.joints[:number] + link.joints[number + 1 :]
                pieces = case.pieces[k][:place] + case.pieces[k][place + 1 :]
                tree = replace(case.tree, links=_with(case.tree.links, k, replace(link, joints=joints)))
                yield Case(tree, _with(case.pieces, k, pieces))


def _plainer_trees(tree: Tree) -> Iterator[Tree]:
    for gravity in (_DOWN, ORIGIN):
        yield replace(tree, gravity=gravity)
    for lines in ("constraints", "tendons"):
        yield from _plainer_lines(tree, lines)
    for number in range(len(tree.actuators)):
        yield replace(tree, actuators=tree.actuators[:number] + tree.actuators[number + 1 :])
    for number, end in enumerate(tree.sensors):
        if len(tree.sensors) > 1:
            yield replace(tree, sensors=tree.sensors[:number] + tree.sensors[number + 1 :])
        for plain in _plainer_ends(end):
            yield replace(tree, sensors=_with(tree.sensors, number, plain))
    yield replace(tree, changed="", away=ORIGIN)
    for k, link in enumerate(tree.links):
        for simpler in _plainer_links(link):
            yield replace(tree, links=_with(tree.links, k, simpler))


def _plainer_lines(tree: Tree, lines: str) -> Iterator[Tree]:
    """Trees with plainer constraints or tendons, or one less; the tendons that actuators pull stay."""
    stated = getattr(tree, lines)
    for number, one in enumerate(stated):
        if len(stated) > 1 and not (lines == "tendons" and tree.actuators):
            yield replace(tree, **{lines: stated[:number] + stated[number + 1 :]})
        for place, end in enumerate(one.ends):
            for plain in _plainer_ends(end):
                yield replace(tree, **{lines: _with(stated, number, replace(one, ends=_with(one.ends, place, plain)))})


def _plainer_ends(end: End) -> Iterator[End]:
    yield from (end._replace(R=IDENTITY, p=ORIGIN), end._replace(R=IDENTITY))
    yield from (end._replace(p=p) for p in (ORIGIN, *_UNITS))


def _plainer_links(link: Link) -> Iterator[Link]:
    for number, joint in enumerate(link.joints):
        for simpler in _plainer_joints(joint):
            yield replace(link, joints=_with(link.joints, number, simpler))
    yield replace(link, com=ORIGIN, inertia=IDENTITY, mass=1.0)
    for com in (ORIGIN, *_UNITS, (1.0, 2.0, 3.0)):
        yield replace(link, com=com)
    for inertia in (IDENTITY, _PRINCIPAL):
        yield replace(link, inertia=inertia)
    yield replace(link, mass=1.0)
    yield replace(link, mass=_rounded(link.mass))
    yield replace(link, compensation=0.0)


def _plainer_joints(joint: Joint) -> Iterator[Joint]:
    yield replace(joint, R=IDENTITY, p=ORIGIN)
    for R in (IDENTITY, *_TURNS):
        yield replace(joint, R=R)
    for p in (ORIGIN, *_UNITS):
        yield replace(joint, p=p)
    for axis in _UNITS:
        yield _about(joint, axis)
    if joint.mimics:
        yield replace(joint, offset=0.0)
        yield replace(joint, ratio=2.0)
    if joint.kind == "helical":
        yield replace(joint, pitch=1.0)
    if any(joint.radii):
        yield replace(joint, radii=(1.0, 2.0, 3.0))
    if joint.armature:
        yield replace(joint, armature=(1.0,) * len(joint.armature))
    yield from (replace(joint, damping=0.0), replace(joint, stiffness=0.0), replace(joint, rest=0.0))


def _plainer_pieces(piece: Piece, *, bound: bool = False) -> Iterator[Piece]:
    """Simpler states of a joint; what constraints bind comes out of closing them, whatever it was before."""
    for name in ("v2", "q2", "tau", "a", "v"):
        values = getattr(piece, name)
        if name == "q2":
            yield replace(piece, q2=piece.q)
        else:
            yield _zeroed(piece, (name,))
            if bound and name == "v":
                continue
            for k, value in enumerate(values):
                for simpler in dict.fromkeys((0.0, 1.0, _rounded(value))):
                    yield _changed(piece, **{name: _with(values, k, simpler)})
    for q in () if bound else _plainer_coordinates(piece.chart, piece.q):
        yield replace(piece, q=q)


def _plainer_coordinates(chart: str, q: tuple[float, ...]) -> Iterator[tuple[float, ...]]:
    """Simpler coordinates on the manifold of a chart: those of unit length stay so."""
    start = (
        len(q) - 4
        if "quaternion" in chart or chart.startswith("free")
        else len(q) - 2
        if "cos sin" in chart
        else len(q)
    )
    for k in range(start):
        for simpler in dict.fromkeys((0.0, 1.0, _rounded(q[k]))):
            yield _with(q, k, simpler)
    units: Sequence[tuple[float, ...]] = ()
    if len(q) - start == 4:
        units = ((0, 0, 0, 1), (1, 0, 0, 0), (0, 1, 0, 0), (0.6, 0.8, 0, 0), (0.5, 0.5, 0.5, 0.5), (0.1, 0.5, 0.5, 0.7))
    elif len(q) - start == 2:
        units = ((1, 0), (0, 1), (0.6, 0.8))
    for unit in units:
        yield (*q[:start], *map(float, unit))


def _rounded(value: float) -> float:
    return float(round(value)) or round(value, 1)
