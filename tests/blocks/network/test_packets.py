"""What a receiver makes of what arrives, packet by packet."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from symofros.blocks.network.packets import Reception, pack, unpack

VALUES = np.array([1.5, -2.0])


def packet(sequence: int, stream: int = 7) -> bytes:
    return pack(stream, sequence, 0.25 * sequence, VALUES + sequence)


def after(*sequences: int, stream: int = 7) -> Reception:
    r = Reception(2, 0.1)
    for i, sequence in enumerate(sequences):
        r.take(packet(sequence, stream), 0.01 * i)
    return r


def test_packets_have_the_documented_bytes() -> None:
    data = pack(0x01020304, 5, 0.5, np.array([1.0]))
    assert data == b"SYMO\x01\x00\x01\x00\x04\x03\x02\x01\x05\x00\x00\x00" + struct.pack("<dd", 0.5, 1.0)
    found = unpack(data, 1)
    assert found is not None and (found.stream, found.sequence, found.t) == (0x01020304, 5, 0.5)
    assert found.values.tolist() == [1.0]


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"SYMO",
        packet(0)[:-1],
        packet(0) + b"\0",
        b"X" + packet(0)[1:],
        packet(0)[:4] + b"\x02\x00" + packet(0)[6:],
        packet(0)[:6] + b"\xff\xff" + packet(0)[8:],
        pack(7, 0, 0.0, np.array([np.nan, 0.0])),
        pack(7, 0, 0.0, np.array([np.inf, 0.0])),
        pack(7, 0, float("nan"), VALUES),
        pack(7, 0, 0.0, np.zeros(8000)),
    ],
)
def test_malformed_packets_are_counted_and_dropped(data: bytes) -> None:
    r = after(0)
    r.take(data, 0.0)
    assert (r.malformed, r.received) == (1, 1) and r.values is not None and np.array_equal(r.values, VALUES)


@pytest.mark.parametrize(
    ("sequences", "lost", "late", "duplicate", "newest"),
    [
        ((0, 1, 2), 0, 0, 0, 2),
        ((0, 3), 2, 0, 0, 3),
        ((0, 3, 1), 1, 1, 0, 3),
        ((0, 3, 1, 2), 0, 2, 0, 3),
        ((0, 0, 1, 1, 0), 0, 0, 3, 1),
        ((0, 3, 1, 1), 1, 1, 1, 3),
        ((5, 4), 0, 1, 0, 5),  # Before the first: nothing was counted as lost.
        ((0, 5000, 1), 4999, 1, 0, 5000),  # So far behind that it may be a duplicate.
        ((2**32 - 1, 0, 1), 0, 0, 0, 1),  # Numbers wrap.
        ((2**32 - 2, 1, 2**32 - 1), 1, 1, 0, 1),
    ],
)
def test_lost_late_and_duplicate_packets_are_counted(
    sequences: tuple[int, ...], lost: int, late: int, duplicate: int, newest: int
) -> None:
    r = after(*sequences)
    assert (r.lost, r.late, r.duplicate) == (lost, late, duplicate)
    assert r.received == len(sequences) - duplicate
    assert r.values is not None and np.array_equal(r.values, VALUES + newest)


def test_random_orders_are_counted_exactly(rng: np.random.Generator) -> None:
    sent = np.arange(2000)
    kept = sent[(rng.random(2000) > 0.05) | (sent == 0)]
    order = kept[np.argsort(kept + rng.uniform(0, 20, len(kept)) * (kept > 0))]
    doubled = [int(s) for s in order for _ in range(1 + (rng.random() < 0.1))]
    r = after(*doubled)
    assert r.lost == kept[-1] + 1 - len(kept) and r.duplicate == len(doubled) - len(kept)
    assert r.received == len(kept) and r.late > 100 and r.values is not None and r.values[0] == VALUES[0] + kept.max()


def test_another_sender_is_ignored_until_the_first_is_silent() -> None:
    r = after(0, 1)
    r.take(packet(100, stream=8), 0.05)
    assert r.foreign == 1 and r.values is not None and r.values[0] == VALUES[0] + 1
    r.take(packet(100, stream=8), 0.2)
    assert r.foreign == 1 and r.values[0] == VALUES[0] + 100 and r.lost == 0


def test_silence_holds_the_value_or_gives_the_fallback() -> None:
    r = Reception(2, 0.1)
    assert r.outputs(0.3, 0.1, "hold", -1.0)["signal"].tolist() == [-1.0, -1.0]
    assert r.outputs(0.3, 0.1, "hold", -1.0)["age"] == pytest.approx(0.2)
    r.take(packet(0), 1.0)
    for t, alive in ((1.05, 1.0), (1.2, 0.0)):
        held, given = r.outputs(t, 0.0, "hold", -1.0), r.outputs(t, 0.0, "value", -1.0)
        assert held["alive"] == given["alive"] == alive and held["age"] == pytest.approx(t - 1.0)
        assert held["signal"].tolist() == VALUES.tolist()
        assert given["signal"].tolist() == (VALUES.tolist() if alive else [-1.0, -1.0])
