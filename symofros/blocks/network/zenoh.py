"""Network by Zenoh, the middleware under ROS 2 and others (the extra `network`); packets as those of UDP.

Peers on this machine find each other by addresses that are written down: nothing is sent to look for others.
"""

from __future__ import annotations

import json
import secrets
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.network.exchange import MAX_TAKEN, Exchange, Receiver, Receiving, Transmitter
from symofros.blocks.network.packets import pack
from symofros.diagrams.block import Environment
from symofros.diagrams.external_block import Running
from symofros.errors import DescriptionError, SymofrosError

_ADDRESS = "127.0.0.1:7447"


@dataclass(frozen=True, kw_only=True)
class _ByZenoh(Exchange):
    key: str
    address: str = _ADDRESS
    listens: bool = False

    def place(self) -> tuple[str, int]:
        """Host and port, split from the address; port 0 if the address has no valid one."""
        host, _, port = self.address.rpartition(":")
        return host.strip("[]"), int(port) if port.isdigit() and len(port) < 6 else 0

    def check(self) -> None:
        """Refuse an invalid address or key.

        Raises:
            DescriptionError: The address or the key is invalid.
        """
        super().check()
        key = self.key
        if not key or key.startswith("/") or key.endswith("/") or "//" in key or any(c in key for c in "?#$\0"):
            raise DescriptionError(
                f"block '{self.name}': no key '{key:.60}'",
                f"'{key:.60}'",
                "names joined by '/', none of them empty",
                "for example arm/state",
            )


@dataclass(frozen=True, kw_only=True)
class ZenohPublisher(_ByZenoh, Transmitter):
    """Publishes its input under a key at each sample; never waits, so packets can be dropped where a reader is slow.

    What it keeps of a run: "sent", how many packets.

    Attributes:
        key: Such as "arm/state"; without wildcards.
        address: HOST:PORT of the peer.
        listens: Whether the peer comes to that address; else it is gone to, as soon as somebody listens.
    """

    def begin(self, environment: Environment) -> Running:
        """Open a session.

        Raises:
            SymofrosError: Zenoh is not installed, or the address is taken.
        """
        return _Publishing(*_opened(self, lambda session: session.declare_publisher(self.key)))


class _Publishing(Running):
    """Packets of one run."""

    def __init__(self, session: Any, publisher: Any) -> None:
        self._session, self._publisher = session, publisher
        self._stream, self._sent = secrets.randbits(32), 0

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Publish one packet."""
        self._publisher.put(pack(self._stream, self._sent, t, inputs["signal"].reshape(-1)))
        self._sent += 1
        return {}

    def kept(self) -> Mapping[str, Array]:
        """Number of packets published."""
        return {"sent": np.asarray(float(self._sent))}

    def end(self) -> None:
        """Close the session."""
        self._session.close()


@dataclass(frozen=True, kw_only=True)
class ZenohSubscriber(_ByZenoh, Receiver):
    """Takes the newest packet under a key at each sample, and counts the others, as UdpReceiver does.

    Attributes:
        key: Key expression to subscribe to, with Zenoh's wildcards.
        size: Values a packet.
        address: HOST:PORT where peers meet.
        listens: Whether peers come to that address; else it is gone to.
        timeout: After so long without a packet the sender counts as silent [s].
        on_silence: Then "hold" the last values or give the "value" fallback; "alive" is 0 either way.
        fallback: Values before the first packet, and on silence.
        unit: Unit of the values.
    """

    listens: bool = True

    def begin(self, environment: Environment) -> Running:
        """Open a session; packets wait in a queue whose oldest are dropped.

        Raises:
            SymofrosError: Zenoh is not installed, or the address is taken.
        """
        waiting: deque[bytes] = deque(maxlen=MAX_TAKEN)

        def heard(sample: Any) -> None:
            waiting.append(bytes(sample.payload))

        session, subscriber = _opened(self, lambda session: session.declare_subscriber(self.key, heard))
        return _Subscribed(self, session, subscriber, waiting)


class _Subscribed(Receiving):
    """Packets of one run."""

    def __init__(self, block: ZenohSubscriber, session: Any, subscriber: Any, waiting: deque[bytes]) -> None:
        super().__init__(block)
        self._session, self._waiting = session, waiting
        self._subscriber = subscriber  # Zenoh hears as long as it is referred to.

    def arrived(self) -> Iterator[bytes]:
        """Packets that wait in the queue; those that arrive meanwhile are left for the next sample."""
        for _ in range(len(self._waiting)):
            yield self._waiting.popleft()

    def end(self) -> None:
        """Close the session."""
        self._session.close()


def _opened(block: _ByZenoh, declare: Callable[[Any], Any]) -> tuple[Any, Any]:
    """Open a session restricted to the block's address, and return it with the endpoint that `declare` makes.

    Raises:
        SymofrosError: Zenoh is not installed, the address is taken, or the key is invalid.
    """
    name, address = block.name, block.address
    try:
        zenoh = import_module("zenoh")
    except ImportError:
        raise SymofrosError.of_extra(
            f"block '{name}': Zenoh is not installed",
            "no module zenoh",
            "network blocks of middleware are an extra",
            "network",
        ) from None
    config = zenoh.Config()
    ends, listens = [f"tcp/{address}"], block.listens
    for key, value in (
        ("mode", "peer"),
        ("scouting/multicast/enabled", False),
        ("scouting/gossip/enabled", False),
        ("listen/endpoints", ends if listens else []),
        ("connect/endpoints", [] if listens else ends),
    ):
        config.insert_json5(key, json.dumps(value))
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise SymofrosError(
            f"block '{name}': can't open {address}",
            f"{error}".split(" at /")[0][:200],
            "one program listens at an address of this machine",
            "choose another port, or let one program listen and the other connect",
        ) from None
    try:
        return session, declare(session)
    except zenoh.ZError as error:
        session.close()
        raise SymofrosError(
            f"block '{name}': no key '{block.key:.60}'",
            f"{error}".split(" at /")[0][:200],
            "a key as Zenoh has them",
            "for example arm/state",
        ) from None
