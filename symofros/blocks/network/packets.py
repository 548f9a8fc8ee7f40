"""What network blocks send: a header and doubles, little-endian; and what a receiver makes of what arrives.

Bytes 0-3 "SYMO", 4-5 version, 6-7 number of values, 8-11 stream (drawn by the sender when it begins), 12-15 sequence
number from 0, wrapping, 16-23 the sender's time [s]; then the values, eight bytes each.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Port

MAGIC = b"SYMO"
VERSION = 1
_HEADER = struct.Struct("<4sHHIId")
# So that a packet stays within what UDP carries.
MAX_VALUES = 8000
# Packets this far behind the newest are still distinguished from duplicates.
_WINDOW = 1024
_ROUND = 1 << 32

Silence = Literal["hold", "value"]


def pack(stream: int, sequence: int, t: float, values: Array) -> bytes:
    """A packet; the sequence number wraps."""
    return _HEADER.pack(MAGIC, VERSION, values.size, stream, sequence % _ROUND, t) + values.astype("<f8").tobytes()


@dataclass(frozen=True)
class Packet:
    """Decoded packet: stream, sequence number, time of sending [s] and values."""

    stream: int
    sequence: int
    t: float
    values: Array


def unpack(data: bytes, size: int) -> Packet | None:
    """A packet of so many values; None for anything else: it is counted and forgotten.

    Values that are not finite count as malformed: one of them would end a simulation.
    """
    if len(data) != _HEADER.size + 8 * size:
        return None
    magic, version, count, stream, sequence, t = _HEADER.unpack_from(data)
    if magic != MAGIC or version != VERSION or count != size or not math.isfinite(t):
        return None
    values = np.frombuffer(data, dtype="<f8", offset=_HEADER.size).astype(np.float64)
    return Packet(stream, sequence, t, values) if np.all(np.isfinite(values)) else None


@dataclass
class Reception:
    """State of one receiver: values of the newest packet, and counts of all that arrived.

    Attributes:
        size: Values a packet.
        silence: After so long without a packet the sender counts as silent, and another may take its place [s].
        values: Values of the newest packet; None before the first.
        stamp: Time of sending, by the sender's clock [s].
        arrived: Time when it was taken, by the receiver's time [s].
        received: Good packets.
        lost: Never arrived, by the gaps in the numbers since the first; one that is late after all is taken off again.
        late: Arrived after a newer one; not used.
        duplicate: Arrived again.
        malformed: No packets of this kind or size, or values that are not finite.
        foreign: Number of packets of another sender while the first is not silent.
    """

    size: int
    silence: float
    values: Array | None = None
    stamp: float = 0.0
    arrived: float = -math.inf
    received: int = 0
    lost: int = 0
    late: int = 0
    duplicate: int = 0
    malformed: int = 0
    foreign: int = 0
    _stream: int = -1
    _newest: int = 0
    _span: int = 0
    _seen: int = field(default=0, repr=False)

    def take(self, data: bytes, t: float) -> None:
        """One datagram, at the receiver's time t."""
        packet = unpack(data, self.size)
        if packet is None:
            self.malformed += 1
            return
        if packet.stream != self._stream:
            if self._stream >= 0 and t - self.arrived <= self.silence:
                self.foreign += 1
                return
            self._stream, self._newest, self._span, self._seen = packet.stream, packet.sequence, 0, 1
            self._use(packet, t)
            return
        ahead = (packet.sequence - self._newest) % _ROUND
        if 0 < ahead < _ROUND // 2:
            self.lost += ahead - 1
            self._span += ahead
            self._seen = 1 if ahead > _WINDOW else (self._seen << ahead | 1) % (1 << _WINDOW)
            self._newest = packet.sequence
            self._use(packet, t)
        else:
            self._behind(-ahead % _ROUND)

    def _behind(self, behind: int) -> None:
        """Count a packet that is this many numbers behind the newest, as a duplicate or as late."""
        if behind < _WINDOW and self._seen >> behind & 1:
            self.duplicate += 1
            return
        self.late += 1
        self.received += 1
        if behind < _WINDOW:
            self._seen |= 1 << behind
            self.lost -= behind < self._span

    def _use(self, packet: Packet, t: float) -> None:
        self.received += 1
        self.values, self.stamp, self.arrived = packet.values, packet.t, t

    def outputs(self, t: float, began: float, on_silence: Silence, fallback: Any) -> dict[str, Any]:
        """Outputs of a receiving block at the receiver's time t; see `receiver_ports`."""
        age = t - (self.arrived if self.values is not None else began)
        alive = self.values is not None and age <= self.silence
        held = self.values is not None and (alive or on_silence == "hold")
        signal = self.values if held else np.broadcast_to(np.asarray(fallback, dtype=np.float64), (self.size,))
        return {"signal": signal, "stamp": self.stamp, "age": age, "lost": self.lost, "alive": float(alive)}

    def counts(self) -> dict[str, Array]:
        """Number of packets received, lost, late, duplicate, malformed and foreign."""
        names = ("received", "lost", "late", "duplicate", "malformed", "foreign")
        return {name: np.asarray(getattr(self, name), dtype=np.float64) for name in names}


def receiver_ports(size: int, unit: str) -> tuple[Port, ...]:
    """Outputs of a receiver: the signal (size), the sender's time of it, seconds since it came, losses, 1 or 0."""
    return (Port("signal", (size,), unit), Port("stamp", (), "s"), Port("age", (), "s"), Port("lost"), Port("alive"))
