"""UDP and Zenoh on this machine."""

from __future__ import annotations

import re
import socket
import sys
import threading
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import PythonBlock, UdpReceiver, UdpTransmitter, ZenohPublisher, ZenohSubscriber
from symofros.diagrams.block import Block
from tests.blocks.sockets import free_port
from tests.diagrams.parts import ramp

# So few that a socket's buffer holds them all: however slow the machine, only the relay loses any.
PACKETS, PERIOD = 100, 2e-3
# A sender counts as silent after this; between two packets a busy machine can take a while [s].
TIMEOUT = 5.0


class Relay(threading.Thread):
    """Takes packets at one port and sends them to another, some of them never; the first and the last come through."""

    def __init__(self, to: int, loss: float) -> None:
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.2)
        self.port, self.to = self.socket.getsockname()[1], to
        self.drops = np.random.default_rng(5).random(PACKETS) < loss
        self.drops[[0, -1]] = False
        self.seen: list[int] = []
        self.done = threading.Event()

    def run(self) -> None:
        while not self.done.is_set():
            try:
                data = self.socket.recv(2048)
            except TimeoutError:
                continue
            sequence = int.from_bytes(data[12:16], "little")
            self.seen.append(sequence)
            if sequence >= PACKETS or not self.drops[sequence]:
                self.socket.sendto(data, ("127.0.0.1", self.to))
        self.socket.close()


def loop_of(*blocks: Block, **inputs: str) -> sf.Simulation:
    d = sf.Diagram("loop")
    d.add(ramp())
    for block in blocks:
        d.add(
            block,
            **(inputs if "transmitter" in type(block).__name__.lower() or isinstance(block, ZenohPublisher) else {}),
        )
    return sf.Simulation(d)


def test_lost_packets_are_tolerated_and_counted() -> None:
    port = free_port()
    relay = Relay(port, 0.05)
    relay.start()
    simulation = loop_of(
        UdpTransmitter(name="tx", port=relay.port, period=PERIOD),
        UdpReceiver(name="rx", port=port, size=2, period=1e-3, timeout=TIMEOUT, unit="s"),
        signal="ramp.y",
    )
    run = simulation.run((PACKETS - 1) * PERIOD + 0.1, dt=1e-3, record=1e-3, realtime=True)
    relay.done.set()
    relay.join()
    assert run.outcome.ok and relay.seen[:PACKETS] == list(range(PACKETS))
    counts = {name: int(value) for name, value in run.kept["rx"].items()}
    dropped = int(relay.drops.sum())
    assert dropped >= 4 and counts["lost"] == dropped == run["rx.lost"][-1]
    assert not any(counts[name] for name in ("late", "duplicate", "malformed", "foreign"))
    signal, stamp, age, alive = (run[f"rx.{name}"] for name in ("signal", "stamp", "age", "alive"))
    assert np.array_equal(signal[:, 0], stamp) and np.array_equal(signal[:, 1], 2.0 * stamp)
    assert alive[0] == 0.0 and not signal[0].any()
    first = np.flatnonzero(alive)[0]
    assert alive[first:].all() and np.all(np.diff(stamp) >= 0.0) and stamp[-1] >= (PACKETS - 1) * PERIOD
    assert np.all(age[first:] < TIMEOUT)


def test_zenoh_receives_published_messages() -> None:
    address = f"127.0.0.1:{free_port(socket.SOCK_STREAM)}"
    way: dict[str, Any] = {"key": "arm/state", "address": address, "period": PERIOD}
    heard = {"size": 2, "timeout": TIMEOUT, "on_silence": "value", "fallback": -1.0}
    simulation = loop_of(ZenohSubscriber(name="rx", **way, **heard), ZenohPublisher(name="tx", **way), signal="ramp.y")
    run = simulation.run(1.0, dt=1e-3, record=1e-3, realtime=True)
    assert run.outcome.ok
    counts = {name: int(value) for name, value in run.kept["rx"].items()}
    # At most the connection's first moments are missing.
    assert counts["received"] > 100 and counts["malformed"] == counts["duplicate"] == 0
    signal, alive = run["rx.signal"], run["rx.alive"]
    assert np.array_equal(signal[alive == 1.0][:, 1], 2.0 * run["rx.stamp"][alive == 1.0])
    assert np.all(signal[alive == 0.0] == -1.0)


def test_a_port_in_use_is_reported_before_the_run() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        simulation = loop_of(UdpReceiver(name="rx", port=other.getsockname()[1], size=2, period=0.01))
        with pytest.raises(sf.SymofrosError, match=r"block 'rx': can't listen at 127\.0\.0\.1:\d+\n.*in use"):
            simulation.run(0.1, dt=1e-2)
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        address = f"127.0.0.1:{other.getsockname()[1]}"
        simulation = loop_of(ZenohSubscriber(name="rx", key="k", address=address, size=2, period=0.01))
        with pytest.raises(sf.SymofrosError, match="block 'rx': can't open") as caught:
            simulation.run(0.1, dt=1e-2)
        assert re.search("in use", str(caught.value))


def test_udp_messages_in_a_loop_arrive_compiled_and_interpreted() -> None:
    port = free_port()
    simulation = loop_of(
        UdpTransmitter(name="tx", port=port, period=0.01),
        UdpReceiver(name="rx", port=port, size=2, period=0.01, offset=0.005),
        signal="ramp.y",
    )
    for run in (simulation.run(0.2, dt=1e-3, record=0.01), simulation.interpret(0.2, dt=1e-3, record=0.01)):
        assert np.array_equal(run["rx.signal"][1:, 0], run.t[:-1]) and np.all(run["rx.age"][1:] == 0.0)
        assert run.kept["tx"]["sent"] == 21 and run.kept["rx"]["received"] == 20


def test_hostile_packets_neither_stop_the_loop_nor_are_accepted() -> None:
    port, rng = free_port(), np.random.default_rng(1)

    def flood(t: float, _: object) -> dict[str, float]:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            for size in rng.integers(0, 200, 30):
                other.sendto(b"SYMO" + rng.bytes(int(size)), ("127.0.0.1", port))
        return {"y": 0.0}

    simulation = loop_of(
        UdpReceiver(name="rx", port=port, size=2, period=0.01, fallback=3.0),
        PythonBlock(name="tx", function=flood, outputs={"y": ()}, period=0.01),
    )
    run = simulation.run(0.1, dt=1e-3, record=0.01)
    assert run.outcome.ok and np.all(run["rx.signal"][1:] == 3.0) and np.all(run["rx.alive"] == 0.0)
    assert run.kept["rx"]["received"] == 0 and run.kept["rx"]["malformed"] > 100


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (UdpReceiver(name="b", port=0, size=1, period=1.0), "no port 0"),
        (UdpReceiver(name="b", port=9, size=1, host="example.com", period=1.0), "no address 'example.com'"),
        (ZenohSubscriber(name="b", key="/a", size=1, period=1.0), "no key '/a'"),
        (ZenohSubscriber(name="b", key="a", size=1, address="here", period=1.0), "no address"),
    ],
)
def test_invalid_ports_addresses_and_keys_are_refused(block: Block, words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        loop_of(block)


def test_an_invalid_key_is_reported_before_the_run() -> None:
    address = f"127.0.0.1:{free_port(socket.SOCK_STREAM)}"
    block = ZenohSubscriber(name="rx", key="a/**b", address=address, size=2, period=0.01)
    with pytest.raises(sf.SymofrosError, match=r"block 'rx': no key 'a/\*\*b'"):
        loop_of(block).run(0.1, dt=1e-2)


def test_a_missing_zenoh_package_is_reported_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zenoh", None)
    d = sf.Diagram("d")
    d.add(ramp())
    d.add(ZenohPublisher(name="tx", key="k", period=0.1), signal="ramp.y")
    with pytest.raises(sf.SymofrosError, match=r"pip install 'symofros\[network\]'"):
        sf.Simulation(d).run(0.1, dt=1e-2)
