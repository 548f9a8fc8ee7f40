"""Network by Zenoh, the middleware under ROS 2 and others (the extra `network`); packets as those of UDP.

Peers on this machine find each other by addresses that are written down: nothing is sent to look for others.
"""

from __future__ import annotations

import json
import secrets
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.network import MAX_TAKEN, beyond, check_address, check_size
from symofros.blocks.packets import Reception, Silence, pack, receiver_ports
from symofros.diagrams.block import Block, Known, Port, Ports
from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.runtime.kernel import Array

_ADDRESS = "127.0.0.1:7447"


@dataclass(frozen=True, kw_only=True)
class ZenohPublisher(Block):
    """Publishes its input under a key at each sample; never waits, so packets can be dropped where a reader is slow.

    What it keeps of a run: "sent", how many packets.

    Attributes:
        key: Such as "arm/state"; without wildcards.
        address: HOST:PORT of the peer.
        listens: Whether the peer comes to that address; else it is gone to, as soon as somebody listens.
    """

    key: str
    address: str = _ADDRESS
    listens: bool = False
    is_opaque: ClassVar[bool] = True

    def ports(self, known: Known) -> Ports:
        """A signal of any shape; entries go row by row."""
        _check(self.name, self.key, self.address)
        shape = known.inputs.get("signal")
        check_size(self.name, int(np.prod(shape)) if shape is not None else 1)
        return Ports((Port("signal", shape),))

    def reaches(self) -> str:
        """The other machine."""
        return beyond(*_parted(self.address))

    def begin(self) -> None:
        """Open a session.

        Raises:
            SymofrosError: Zenoh is not installed, or the address is taken.
        """
        session, publisher = _opened(self, lambda session: session.declare_publisher(self.key))
        object.__setattr__(self, "_open", (session, publisher, secrets.randbits(32)))
        object.__setattr__(self, "_sent", 0)

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Publish one packet."""
        _, publisher, stream = self.__dict__["_open"]
        sent = self.__dict__["_sent"]
        publisher.put(pack(stream, sent, t, inputs["signal"].reshape(-1)))
        object.__setattr__(self, "_sent", sent + 1)
        return {}

    def kept(self) -> Mapping[str, Array]:
        """How many packets were published."""
        return {"sent": np.asarray(float(self.__dict__["_sent"]))}

    def end(self) -> None:
        """Close the session."""
        self.__dict__["_open"][0].close()


@dataclass(frozen=True, kw_only=True)
class ZenohSubscriber(Block):
    """Takes the newest packet under a key at each sample, and counts the others, as UdpReceiver does.

    Attributes:
        key: What to hear; wildcards as Zenoh has them.
        size: Values a packet.
        address: HOST:PORT where peers meet.
        listens: Whether peers come to that address; else it is gone to.
        timeout: After so long without a packet the sender counts as silent [s].
        on_silence: Then "hold" the last values or give the "value" fallback; "alive" is 0 either way.
        fallback: Values before the first packet, and on silence.
        unit: Of the values.
    """

    key: str
    size: int
    address: str = _ADDRESS
    listens: bool = True
    timeout: float = 0.1
    on_silence: Silence = "hold"
    fallback: Any = 0.0
    unit: str = ""
    is_opaque: ClassVar[bool] = True

    def ports(self, known: Known) -> Ports:
        """No inputs; the signal (size), its stamp and age [s], packets lost, and 1 while the sender is alive."""
        _check(self.name, self.key, self.address)
        check_size(self.name, self.size)
        return Ports((), receiver_ports(self.size, self.unit))

    def reaches(self) -> str:
        """The address, if it is another machine's or others can reach it."""
        return beyond(*_parted(self.address))

    def begin(self) -> None:
        """Open a session; packets wait in a queue whose oldest are dropped.

        Raises:
            SymofrosError: Zenoh is not installed, or the address is taken.
        """
        waiting: deque[bytes] = deque(maxlen=MAX_TAKEN)

        def heard(sample: Any) -> None:
            waiting.append(bytes(sample.payload))

        session, subscriber = _opened(self, lambda session: session.declare_subscriber(self.key, heard))
        object.__setattr__(self, "_open", (session, subscriber, waiting, Reception(self.size, self.timeout)))
        object.__setattr__(self, "_began", None)

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Empty the queue, and say what is known now."""
        _, _, waiting, reception = self.__dict__["_open"]
        if self.__dict__["_began"] is None:
            object.__setattr__(self, "_began", t)
        for _ in range(len(waiting)):
            reception.take(waiting.popleft(), t)
        found: Mapping[str, Any] = reception.outputs(t, self.__dict__["_began"], self.on_silence, self.fallback)
        return found

    def kept(self) -> Mapping[str, Array]:
        """How many packets became what."""
        counts: Mapping[str, Array] = self.__dict__["_open"][3].counts()
        return counts

    def end(self) -> None:
        """Close the session."""
        self.__dict__["_open"][0].close()


def _parted(address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    return host.strip("[]"), int(port) if port.isdigit() and len(port) < 6 else 0


def _check(name: str, key: str, address: str) -> None:
    check_address(name, *_parted(address))
    if not key or key.startswith("/") or key.endswith("/") or "//" in key or any(c in key for c in "?#$\0"):
        raise DescriptionError(Problem(f"block '{name}': no key '{key:.60}'", f"'{key:.60}'",
                                       "names joined by '/', none of them empty", "for example arm/state"))  # fmt: skip


def _opened(block: ZenohPublisher | ZenohSubscriber, declare: Callable[[Any], Any]) -> tuple[Any, Any]:
    """A peer that talks by one address only, and what it declares.

    Raises:
        SymofrosError: Zenoh is not installed, the address is taken, or the key is none.
    """
    name, address = block.name, block.address
    try:
        zenoh = import_module("zenoh")
    except ImportError:
        raise SymofrosError(str(Problem(f"block '{name}': Zenoh is not installed", "no module zenoh",
                                        "network blocks of middleware are an extra", "pip install 'symofros[network]'")
                                )) from None  # fmt: skip
    config = zenoh.Config()
    ends, listens = [f"tcp/{address}"], block.listens
    for key, value in (
        ("mode", "peer"), ("scouting/multicast/enabled", False), ("scouting/gossip/enabled", False),
        ("listen/endpoints", ends if listens else []), ("connect/endpoints", [] if listens else ends),
    ):  # fmt: skip
        config.insert_json5(key, json.dumps(value))
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise SymofrosError(str(Problem(f"block '{name}': can't open {address}", f"{error}".split(" at /")[0][:200],
                                        "one program listens at an address of this machine",
                                        "choose another port, or let one side listen and the other connect")
                                )) from None  # fmt: skip
    try:
        return session, declare(session)
    except zenoh.ZError as error:
        session.close()
        raise SymofrosError(str(Problem(f"block '{name}': no key '{block.key:.60}'", f"{error}".split(" at /")[0][:200],
                                        "a key as Zenoh has them", "for example arm/state"))) from None  # fmt: skip
