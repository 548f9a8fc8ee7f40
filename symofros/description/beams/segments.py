"""Beams in segments: one beam as several in series, each clamped to the tip of the one before.

Bodies beyond a tip turn with it exactly, so that each segment deflects relative to a root that has turned: what
second-order theory leaves out falls with the square of the number of segments (docs/theory/beams.md, section 6).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, replace
from functools import partial
from typing import Any

from symofros.description.beams.beam import STATION, Beam, BeamLoad
from symofros.description.forces import Anchor
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint
from symofros.description.values import Term, Value, Vector, substituted
from symofros.errors import DescriptionError
from symofros.expr.expression import Expression

# Extremity frame of each segment but the last, that carries the next; underscores follow where the beam has such one.
_END = "end"


def segment_names(beam: Beam) -> tuple[str, ...]:
    """Names of a beam's segments, root first: b, b.2, b.3 and so on."""
    return (beam.name, *(f"{beam.name}.{k}" for k in range(2, beam.segments + 1)))


def segments_of(beam: Beam) -> tuple[Beam, ...]:
    """The beams in series that a beam in segments stands for.

    The first bears the beam's name and joint, the last its extremity frames.

    Raises:
        DescriptionError: A load has components along the axes of the undeformed beam, which segments do not have.
    """
    for load in beam.loads:
        if load.axes == "body":
            raise DescriptionError(
                f"beam '{beam.name}': a load along axes of the body, of a beam in segments",
                f"{beam.segments} segments",
                "segments turn, so that the axes of the undeformed beam are not theirs",
                "give the load along axes of the world, or put a rigid body with a load on the tip",
            )
    names, n, end = segment_names(beam), beam.segments, _END
    while any(frame.name == end for frame in beam.frames):
        end += "_"
    length = (Term(beam.length) / Term(float(n))).value
    segments = []
    for k, name in enumerate(names):
        station = _station(beam.length, k, n)
        clamp = Joint(f"{name}.clamp", "fixed", names[k - 1], end)
        along_axis = beam.changed_along_axis(partial(substituted, name=STATION, replacement=station))
        segments.append(
            replace(
                beam,
                name=name,
                joint=clamp if k else beam.joint,
                length=length,
                frames=tuple(_frames(beam.frames, k, n, end)),
                loads=tuple(_loads(beam.loads, k, n, station)),
                segments=1,
                stations=tuple(_stations(beam, k)),
                **along_axis,
            )
        )
    return tuple(segments)


def _station(length: Value, k: int, n: int) -> Value:
    """The station x of the whole beam, by that of segment k."""
    x = Expression("symbol", name=STATION)
    return (Term(x) + Term(k / n) * Term(length)).value if k else x


def _segment_at(xi: float, n: int) -> tuple[int, float]:
    """The segment at a station, of two the one nearer to the root, and the station on it."""
    k = next((k for k in range(n) if xi <= (k + 1) / n), n - 1)
    return k, min(max(xi * n - k, 0.0), 1.0)


def _frames(frames: Iterable[Frame], k: int, n: int, end: str) -> Iterator[Frame]:
    """The frames of segment k, and the one, of a name that is none of theirs, that carries the next segment."""
    if k < n - 1:
        yield Frame(end)
    for frame in frames:
        on, xi = _segment_at(frame.station, n)
        if on == k:
            yield frame if frame.at is None else replace(frame, at=xi)


def _stations(beam: Beam, k: int) -> Iterable[float]:
    """The stations of section forces on segment k; those of a rigid beam have none."""
    if not beam.modes:
        return beam.stations
    return (xi for on, xi in (_segment_at(x, beam.segments) for x in beam.stations) if on == k)


def _loads(loads: Iterable[BeamLoad], k: int, n: int, station: Value) -> Iterator[BeamLoad]:
    """The loads on segment k."""
    for load in loads:
        if load.at is None:
            yield replace(load, force=_from_root(load.force, station), torque=_from_root(load.torque, station))
        else:
            on, xi = _segment_at(load.at, n)
            if on == k:
                yield replace(load, at=xi)


def _from_root(vector: Vector, station: Value) -> Vector:
    """A vector whose components are formulas of the station, by that of a segment."""
    x, y, z = (substituted(component, STATION, station) for component in vector)
    return x, y, z


class SegmentAnchors:
    """Where the frames of beams in segments are: each on the segment at its station.

    Args:
        beams: Beams in segments.
    """

    def __init__(self, beams: Iterable[Beam]) -> None:
        self.places: Mapping[tuple[str, str], str] = {
            (beam.name, frame.name): segment_names(beam)[_segment_at(frame.station, beam.segments)[0]]
            for beam in beams
            for frame in beam.frames
        }

    def joint(self, joint: Joint) -> Joint:
        """A joint that may be placed on a frame of a beam."""
        parent, frame = self.anchor((joint.parent, joint.frame))
        return joint if parent == joint.parent else replace(joint, parent=parent, frame=frame)

    def anchor(self, anchor: Anchor) -> Anchor:
        """A frame of a body, as stated, where it is."""
        body, frame = anchor
        return anchor if frame is None else (self.places.get((body, frame), body), frame)

    def anchored(self, noun: Any) -> Any:
        """A connection or a constraint, with its anchors where they are."""
        labels = [item.name for item in fields(noun) if item.name in ("first", "second", "anchor")]
        return replace(noun, **{label: self.anchor(getattr(noun, label)) for label in labels}) if labels else noun
