"""What blocks that exchange packets with other programs share, by whatever way the packets go."""

from __future__ import annotations

import ipaddress
import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from symofros.base.arrays import Array
from symofros.blocks.network.packets import MAX_VALUES, Reception, Silence, receiver_ports
from symofros.diagrams.block import Environment, Port, Ports
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.errors import DescriptionError

LOCALHOST = "127.0.0.1"
# Packets that one sample takes: a flood may not stop the loop.
MAX_TAKEN = 1000


@dataclass(frozen=True, kw_only=True)
class Exchange(ExternalBlock):
    """A block that talks by an address."""

    @abstractmethod
    def place(self) -> tuple[str, int]:
        """Host and port."""

    def check(self) -> None:
        """Refuse an invalid host or port.

        Raises:
            DescriptionError: The host is not an IP address, or the port is not in 1 to 65535.
        """
        host, port = self.place()
        try:
            ipaddress.ip_address(host)
        except ValueError:
            raise DescriptionError(
                f"block '{self.name}': no address '{host:.60}'",
                f"'{host:.60}'",
                "a host is an IP address",
                "127.0.0.1 is this machine",
            ) from None
        if not 1 <= port <= 65535:
            raise DescriptionError(
                f"block '{self.name}': no port {port}", f"{port}", "a port is from 1 to 65535", "choose one above 1023"
            )

    def reaches(self) -> str:
        """The address, if it is another machine's or others can reach it."""
        host, port = self.place()
        try:
            return "" if ipaddress.ip_address(host).is_loopback else f"{host}:{port}"
        except ValueError:
            return f"{host:.60}:{port}"


@dataclass(frozen=True, kw_only=True)
class Transmitter(Exchange):
    """Sends its input at each sample, as one packet (`symofros.blocks.network.packets`)."""

    def ports(self, environment: Environment) -> Ports:
        """A signal of any shape; entries go row by row."""
        self.check()
        shape = environment.inputs.get("signal")
        check_size(self.name, math.prod(shape) if shape is not None else 1)
        return Ports((Port("signal", shape),))


@dataclass(frozen=True, kw_only=True)
class Receiver(Exchange):
    """Takes the newest packet that has arrived at each sample, and counts the others.

    Attributes:
        size: Values a packet.
        timeout: After so long without a packet the sender counts as silent [s].
        on_silence: Then "hold" the last values or give the "value" fallback; "alive" is 0 either way.
        fallback: Values before the first packet, and on silence.
        unit: Unit of the values.
    """

    size: int
    timeout: float = 0.1
    on_silence: Silence = "hold"
    fallback: Any = 0.0
    unit: str = ""

    def ports(self, environment: Environment) -> Ports:
        """No inputs; the signal (size), its stamp and age [s], packets lost, and 1 while the sender is alive."""
        self.check()
        check_size(self.name, self.size)
        return Ports((), receiver_ports(self.size, self.unit))


class Receiving(Running):
    """A receiver in one run.

    Args:
        block: Block that receives.
    """

    def __init__(self, block: Receiver) -> None:
        self._block = block
        self._reception = Reception(block.size, block.timeout)
        self._began: float | None = None

    @abstractmethod
    def arrived(self) -> Iterable[bytes]:
        """Packets that have arrived since the last sample, MAX_TAKEN at most; nothing is waited for."""

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Read the packets that have arrived, and return the outputs at time t."""
        if self._began is None:
            self._began = t
        for data in self.arrived():
            self._reception.take(data, t)
        return self._reception.outputs(t, self._began, self._block.on_silence, self._block.fallback)

    def kept(self) -> Mapping[str, Array]:
        """Number of packets received, lost, late, duplicate, malformed and foreign."""
        return self._reception.counts()


def check_size(name: str, size: int) -> None:
    """Refuse signals that no packet holds.

    Raises:
        DescriptionError: Out of 1 to MAX_VALUES.
    """
    if not 1 <= size <= MAX_VALUES:
        raise DescriptionError(
            f"block '{name}': {size} values a packet",
            f"{size}",
            f"a packet holds 1 to {MAX_VALUES} values",
            "send less, or by several blocks",
        )
