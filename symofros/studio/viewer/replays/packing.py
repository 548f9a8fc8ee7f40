"""Recordings of viser in fewer bytes: meshes as walks, poses as what changes of them; `unpack.js` restores them."""

from __future__ import annotations

import json
import zlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.studio.viewer.replays.connectivity import walk

TURN_STEP = 2.0**-17
"""Step of the components of quaternions."""
_POSES = {"position": 3, "wxyz": 4}
_FEW = 3  # Poses of a node, by which they are worth a series of their own.
_FINEST = 24  # Binary digits after the point that corners on a grid have at most.
_INDEX = "__binary_index"
_MOST = 1 << 32  # Bytes of a recording, which holds one scene and its poses.

Message = dict[str, Any]


def packed(recording: bytes, step: float) -> bytes:
    """A recording packed: a deflated stream of its messages as JSON, then of its arrays.

    Args:
        recording: What `StateSerializer.serialize` of viser returns.
        step: Step of positions [m]; corners keep their places.
    """
    whole = import_module("zstandard").ZstdDecompressor().decompress(recording[8:], max_output_size=_MOST)
    size = int.from_bytes(whole[:8], "little")
    found = import_module("msgspec").msgpack.decode(whole[8 : 8 + size])
    packer = _Packer(_buffers(whole, 8 + size, found["binaryBufferLengths"]), step)
    header = {
        "duration": found["durationSeconds"],
        "version": found["viserVersion"],
        "messages": packer.messages(found["messages"]),
        **packer.tables(),
    }
    text = json.dumps(header, separators=(",", ":")).encode()
    deflate = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    parts = [len(text).to_bytes(4, "little"), text, *packer.streams]
    return b"".join([deflate.compress(b"".join(parts)), deflate.flush()])


def _buffers(whole: bytes, start: int, sizes: list[int]) -> list[bytes]:
    """Arrays of a recording: each begins at a multiple of eight bytes."""
    found = []
    for size in sizes:
        start = -(-start // 8) * 8
        found.append(whole[start : start + size])
        start += size
    return found


@dataclass
class _Packer:
    """What is packed so far.

    Attributes:
        buffers: Arrays of the recording.
        step: Step of positions [m].
        streams: Bytes of the packed arrays, in the order of `arrays` and then of `series`.
    """

    buffers: list[bytes]
    step: float
    streams: list[bytes] = field(default_factory=list)
    _arrays: list[dict[str, Any]] = field(default_factory=list)
    _places: dict[tuple[int, ...], int] = field(default_factory=dict)
    _count: int = 0
    _series: list[dict[str, Any]] = field(default_factory=list)
    _groups: dict[tuple[int, ...], int] = field(default_factory=dict)
    _poses: list[list[Array]] = field(default_factory=list)

    def messages(self, stated: list[tuple[float, Message]]) -> list[Any]:
        """Times with messages, or with the numbers of groups of poses."""
        often = Counter(_node_of(message) for _, message in stated)
        numbers: dict[str, int] = {}
        found: list[Any] = []
        run: list[int] = []
        at = 0.0
        for time, message in stated:
            node, poses = _node_of(message), _pose_of(message)
            serial = poses is not None and often[node] >= _FEW
            if run and (time != at or not serial):
                found.append([at, self._group(run)])
                run = []
            at = time
            if serial:
                run.append(self._pose(numbers, node, message))
            else:
                found.append([_rounded(time), self._message(message)])
        if run:
            found.append([at, self._group(run)])
        return [[_rounded(time), what] for time, what in found]

    def tables(self) -> dict[str, Any]:
        """Arrays, series and groups, once all messages are packed."""
        for series, poses in zip(self._series, self._poses, strict=True):
            values = np.rint(np.array(poses) / series["step"]).astype(np.int64)
            padded = np.concatenate([np.zeros((2, values.shape[1]), np.int64), values])
            self.streams.append(_planes(padded[2:] - 2 * padded[1:-1] + padded[:-2]))
        return {"arrays": self._arrays, "series": self._series, "groups": list(self._groups)}

    # Poses.

    def _pose(self, numbers: dict[str, int], node: str, message: Message) -> int:
        kind = _pose_of(message)
        assert kind is not None
        if node not in numbers:
            numbers[node] = len(self._series)
            rest = {key: value for key, value in message.items() if key != kind}
            step = self.step if kind == "position" else TURN_STEP
            self._series.append({"message": rest, "of": kind, "step": step, "count": 0})
            self._poses.append([])
        k = numbers[node]
        self._series[k]["count"] += 1
        self._poses[k].append(message[kind])
        return k

    def _group(self, series: list[int]) -> int:
        return self._groups.setdefault(tuple(series), len(self._groups))

    # Arrays.

    def _message(self, value: Any) -> Any:
        """A message, or a part of one, whose arrays are packed."""
        if not isinstance(value, Mapping):
            return value
        if _INDEX in value:
            return {**value, _INDEX: self._raw(value[_INDEX])}
        if value.get("type") != "MeshMessage":
            return {key: self._message(item) for key, item in value.items()}
        props = dict(value["props"])
        first = self._mesh(props["faces"][_INDEX], props["vertices"][_INDEX])
        for k, key in enumerate(("faces", "vertices")):
            props[key] = {**props[key], _INDEX: first + k}
        return {**value, "props": props}

    def _raw(self, index: int) -> int:
        """The number of an array that is taken as it is."""
        if (index,) not in self._places:
            data = self.buffers[index]
            self._add((index,), {"size": len(data)}, 1, data)
        return self._places[index,]

    def _mesh(self, faces: int, vertices: int) -> int:
        """The number of the array of a mesh's triangles; that of its corners follows it."""
        if (faces, vertices) not in self._places:
            corners = np.frombuffer(self.buffers[vertices], "<f4").reshape(-1, 3).astype(np.float64)
            path = walk(np.frombuffer(self.buffers[faces], "<u4").reshape(-1, 3).astype(np.int64), len(corners))
            ordered = corners[path.order]
            step = _grid(ordered)
            sizes = {"faces": len(self.buffers[faces]) // 12, "steps": len(path.steps), "back": len(path.back)}
            stream = path.steps.tobytes() + _planes(path.back[:, None])
            if step is None:
                stream += ordered.astype("<f4").tobytes()
            else:
                whole = np.rint(ordered / step).astype(np.int64)
                padded = np.concatenate([whole, np.zeros((1, 3), np.int64)])  # The last stands for -1.
                a, b, c = path.near.T
                stream += _planes(whole - (padded[a] + padded[b] - padded[c]))
            self._add((faces, vertices), {**sizes, "corners": len(corners), "step": step or 0}, 2, stream)
        return self._places[faces, vertices]

    def _add(self, key: tuple[int, ...], array: dict[str, Any], count: int, stream: bytes) -> None:
        self._places[key] = self._count
        self._count += count
        self._arrays.append(array)
        self.streams.append(stream)


def _pose_of(message: Message) -> str | None:
    """The key of what a message sets, if that is a pose alone."""
    return next((key for key in _POSES if key in message), None)


def _node_of(message: Message) -> str:
    """What a pose is of, as text; "" of other messages."""
    kind = _pose_of(message)
    return "" if kind is None else json.dumps({key: value for key, value in message.items() if key != kind})


def _rounded(time: float) -> float:
    return round(time, 9)


def _grid(corners: Array) -> float | None:
    """The coarsest step that all corners are multiples of; None where there is none."""
    for digits in range(_FINEST):
        scaled = corners * 2.0**digits
        if np.array_equal(scaled, np.rint(scaled)):
            return float(2.0**-digits) if np.abs(scaled).max(initial=0.0) < 2**30 else None
    return None


def _planes(numbers: npt.NDArray[np.int64]) -> bytes:
    """Whole numbers (n, k) column by column, the lowest byte of each, then the next, up to the fourth."""
    folded = ((numbers << 1) ^ (numbers >> 63)).T.astype("<u4")
    return np.ascontiguousarray(folded).view(np.uint8).reshape(*folded.shape, 4).transpose(0, 2, 1).tobytes()
