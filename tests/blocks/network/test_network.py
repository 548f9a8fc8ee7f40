"""UDP and Zenoh between two processes on this machine."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import UdpReceiver, UdpTransmitter, ZenohPublisher, ZenohSubscriber
from symofros.diagrams.block import Block, Environment
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.diagrams.result import DiagramRun
from tests.blocks.sockets import free_port
from tests.blocks.sources import Ramp

ROOT = Path(__file__).parents[3]
# So few that a socket's buffer holds them all: however slow the machine, only the relay loses any.
PACKETS, PERIOD = 250, 2e-3
# A sender counts as silent after this; between two packets a busy machine can take a while [s].
TIMEOUT = 0.5

# A program of its own: compiles, says so, waits for a line, sends PACKETS packets.
SENDER = f"""
import sys
import symofros as sf
from symofros.blocks import UdpTransmitter, ZenohPublisher
from symofros.runtime.calls.binding import native_library
from tests.blocks.sources import Ramp

d = sf.Diagram("sender")
d.add(Ramp(name="ramp"))
d.add({{block}}, signal="ramp.y")
simulation = sf.Simulation(d)
simulation.compiled
native_library()
print("ready", flush=True)
sys.stdin.readline()
run = simulation.run({(PACKETS - 1) * PERIOD}, dt=1e-3, realtime=True)
print(run.kept["tx"], flush=True)
"""


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
            if not self.drops[sequence]:
                self.socket.sendto(data, ("127.0.0.1", self.to))
        self.socket.close()


def heard_from(sender: str, receiver: Block, t_end: float) -> DiagramRun:
    """Run a receiver in real time while another process sends."""
    d = sf.Diagram("receiver")
    d.add(receiver)
    d.add(Ramp(name="clock"))
    simulation = sf.Simulation(d)
    simulation.run(0.01, dt=1e-3)
    child = subprocess.Popen(
        [sys.executable, "-c", SENDER.format(block=sender)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    assert child.stdin and child.stdout
    try:
        assert child.stdout.readline() == "ready\n"
        starts = threading.Timer(0.1, lambda: (child.stdin.write("go\n"), child.stdin.flush()))
        starts.start()
        run = simulation.run(t_end, dt=1e-3, record=1e-3, realtime=True)
        starts.join()
        counts = child.stdout.readline()
        assert f"'sent': array({PACKETS}.)" in counts, counts
        assert child.wait(10) == 0
    finally:
        child.kill()
        child.stdin.close()
        child.stdout.close()
    return run


@pytest.mark.slow
def test_a_lossy_line_is_survived_and_its_losses_counted() -> None:
    port = free_port()
    relay = Relay(port, 0.01)
    relay.start()
    receiver = UdpReceiver(name="rx", port=port, size=2, period=1e-3, timeout=TIMEOUT, unit="s")
    run = heard_from(f'UdpTransmitter(name="tx", port={relay.port}, period={PERIOD})', receiver, 2.0)
    relay.done.set()
    relay.join()
    assert run.outcome.ok and relay.seen == list(range(PACKETS))
    counts = {name: int(value) for name, value in run.kept["rx"].items()}
    dropped = int(relay.drops.sum())
    assert dropped >= 4
    assert counts == {
        "received": PACKETS - dropped,
        "lost": dropped,
        "late": 0,
        "duplicate": 0,
        "malformed": 0,
        "foreign": 0,
    }
    signal, stamp, age, alive = (run[f"rx.{name}"] for name in ("signal", "stamp", "age", "alive"))
    assert np.array_equal(signal[:, 0], stamp) and np.array_equal(signal[:, 1], 2.0 * stamp)
    assert alive[0] == 0.0 and not signal[0].any()
    first, last = np.flatnonzero(alive)[[0, -1]]
    assert alive[first : last + 1].all() and np.all(np.diff(stamp) >= 0.0)
    # Then the sender is gone: the last values are held, and said to be old.
    assert stamp[-1] == pytest.approx((PACKETS - 1) * PERIOD) and alive[-1] == 0.0
    assert np.all(signal[last:] == signal[-1]) and np.all(age[last + 1 :] > TIMEOUT)
    assert run["rx.lost"][-1] == dropped


@pytest.mark.slow
def test_zenoh_between_two_processes() -> None:
    address = f"127.0.0.1:{free_port(socket.SOCK_STREAM)}"
    receiver = ZenohSubscriber(
        name="rx",
        key="arm/state",
        size=2,
        address=address,
        period=1e-3,
        timeout=TIMEOUT,
        on_silence="value",
        fallback=-1.0,
    )
    sender = f'ZenohPublisher(name="tx", key="arm/state", address="{address}", period={PERIOD})'
    run = heard_from(sender, receiver, 2.0)
    assert run.outcome.ok
    counts = {name: int(value) for name, value in run.kept["rx"].items()}
    # At most the connection's first moments are missing.
    assert counts["received"] > 0.5 * PACKETS and counts["malformed"] == counts["duplicate"] == 0
    signal, alive = run["rx.signal"], run["rx.alive"]
    assert np.array_equal(signal[alive == 1.0][:, 1], 2.0 * run["rx.stamp"][alive == 1.0])
    assert np.all(signal[alive == 0.0] == -1.0) and run["rx.stamp"][-1] == pytest.approx((PACKETS - 1) * PERIOD)


def loop_of(*blocks: Block, **inputs: str) -> sf.Simulation:
    d = sf.Diagram("loop")
    d.add(Ramp(name="ramp"))
    for block in blocks:
        d.add(block, **(inputs if "transmitter" in type(block).__name__.lower() else {}))
    return sf.Simulation(d)


def test_a_port_in_use_is_told_before_the_run() -> None:
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


def test_what_is_sent_in_a_loop_arrives_and_both_ways_of_running_agree() -> None:
    port = free_port()
    simulation = loop_of(
        UdpTransmitter(name="tx", port=port, period=0.01),
        UdpReceiver(name="rx", port=port, size=2, period=0.01, offset=0.005),
        signal="ramp.y",
    )
    for run in (simulation.run(0.2, dt=1e-3, record=0.01), simulation.interpret(0.2, dt=1e-3, record=0.01)):
        assert np.array_equal(run["rx.signal"][1:, 0], run.t[:-1]) and np.all(run["rx.age"][1:] == 0.0)
        assert run.kept["tx"]["sent"] == 21 and run.kept["rx"]["received"] == 20


def test_hostile_packets_neither_stop_the_loop_nor_get_in(rng: np.random.Generator) -> None:
    port = free_port()
    simulation = loop_of(
        UdpReceiver(name="rx", port=port, size=2, period=0.01, fallback=3.0),
        Flood(name="tx", port=port, period=0.01),
    )
    run = simulation.run(0.1, dt=1e-3, record=0.01)
    assert run.outcome.ok and np.all(run["rx.signal"][1:] == 3.0) and np.all(run["rx.alive"] == 0.0)
    assert run.kept["rx"]["received"] == 0 and run.kept["rx"]["malformed"] > 100


@dataclass(frozen=True, kw_only=True)
class Flood(ExternalBlock):
    """Sends anything but packets."""

    port: int

    def begin(self, environment: Environment) -> Running:
        return Flooding(self.port)


class Flooding(Running):
    def __init__(self, port: int) -> None:
        self.to, self.socket = ("127.0.0.1", port), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def call(self, t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        rng = np.random.default_rng(int(1e3 * t))
        for size in rng.integers(0, 200, 30):
            self.socket.sendto(b"SYMO" + rng.bytes(int(size)), self.to)
        return {}

    def end(self) -> None:
        self.socket.close()


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (UdpReceiver(name="b", port=0, size=1, period=1.0), "no port 0"),
        (UdpReceiver(name="b", port=9, size=0, period=1.0), "0 values a packet"),
        (UdpReceiver(name="b", port=9, size=1, host="example.com", period=1.0), "no address 'example.com'"),
        (UdpReceiver(name="b", port=9, size=1), "calls Python and has no sample time"),
        (ZenohSubscriber(name="b", key="/a", size=1, period=1.0), "no key '/a'"),
        (ZenohSubscriber(name="b", key="a", size=1, address="here", period=1.0), "no address"),
    ],
)
def test_what_does_not_fit_is_told(block: Block, words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        loop_of(block)


def test_a_key_that_is_none_is_told_before_the_run() -> None:
    address = f"127.0.0.1:{free_port(socket.SOCK_STREAM)}"
    block = ZenohSubscriber(name="rx", key="a/**b", address=address, size=2, period=0.01)
    with pytest.raises(sf.SymofrosError, match=r"block 'rx': no key 'a/\*\*b'"):
        loop_of(block).run(0.1, dt=1e-2)


def test_zenoh_missing_is_told_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zenoh", None)
    d = sf.Diagram("d")
    d.add(Ramp(name="ramp"))
    d.add(ZenohPublisher(name="tx", key="k", period=0.1), signal="ramp.y")
    with pytest.raises(sf.SymofrosError, match=r"pip install 'symofros\[network\]'"):
        sf.Simulation(d).run(0.1, dt=1e-2)
