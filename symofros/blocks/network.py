"""Network (section 6.2 of the paper): signals sent to and taken from other programs, by UDP.

Neither waits: a packet that can't be sent now is dropped, and what has not arrived is not waited for. UDP knows no
authentication; both stay on this machine unless their `host` says otherwise.
"""

from __future__ import annotations

import ipaddress
import math
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.packets import MAX_VALUES, Reception, Silence, pack, receiver_ports
from symofros.diagrams.block import Block, Known, Port, Ports
from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.runtime.kernel import Array

LOCALHOST = "127.0.0.1"
# Datagrams that one sample takes off the socket: a flood may not stop the loop.
MAX_TAKEN = 1000


@dataclass(frozen=True, kw_only=True)
class UdpTransmitter(Block):
    """Sends its input at each sample, as one packet (`symofros.blocks.packets`).

    What it keeps of a run: "sent" and "dropped", how many packets.

    Attributes:
        port: Where to send.
        host: To which machine; this one by default.
    """

    port: int
    host: str = LOCALHOST
    is_opaque: ClassVar[bool] = True

    def ports(self, known: Known) -> Ports:
        """A signal of any shape; entries go row by row."""
        check_address(self.name, self.host, self.port)
        shape = known.inputs.get("signal")
        check_size(self.name, math.prod(shape) if shape is not None else 1)
        return Ports((Port("signal", shape),))

    def reaches(self) -> str:
        """The other machine."""
        return beyond(self.host, self.port)

    def begin(self) -> None:
        """Open a socket; packets of this run are a stream of their own."""
        sender = socket.socket(socket.AF_INET6 if ":" in self.host else socket.AF_INET, socket.SOCK_DGRAM)
        sender.setblocking(False)
        object.__setattr__(self, "_open", _Sender(sender, secrets.randbits(32)))

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Send one packet, or drop it."""
        sender: _Sender = self.__dict__["_open"]
        data = pack(sender.stream, sender.sequence, t, inputs["signal"].reshape(-1))
        sender.sequence += 1
        try:
            sender.socket.sendto(data, (self.host, self.port))
            sender.sent += 1
        except OSError:  # The buffer is full, or nobody is there: the loop goes on.
            sender.dropped += 1
        return {}

    def kept(self) -> Mapping[str, Array]:
        """How many packets were sent and dropped."""
        sender: _Sender = self.__dict__["_open"]
        return {"sent": np.asarray(float(sender.sent)), "dropped": np.asarray(float(sender.dropped))}

    def end(self) -> None:
        """Close the socket."""
        self.__dict__["_open"].socket.close()


@dataclass
class _Sender:
    socket: socket.socket
    stream: int
    sequence: int = 0
    sent: int = 0
    dropped: int = 0


@dataclass(frozen=True, kw_only=True)
class UdpReceiver(Block):
    """Takes the newest packet that has arrived at each sample, and counts the others.

    What it keeps of a run: "received", "lost", "late", "duplicate", "malformed" and "foreign", how many packets
    (`symofros.blocks.packets.Reception`).

    Attributes:
        port: Where to listen.
        size: Values a packet.
        host: The address to listen at; this machine's own by default.
        timeout: After so long without a packet the sender counts as silent [s].
        on_silence: Then "hold" the last values or give the "value" fallback; "alive" is 0 either way.
        fallback: Values before the first packet, and on silence.
        unit: Of the values.
    """

    port: int
    size: int
    host: str = LOCALHOST
    timeout: float = 0.1
    on_silence: Silence = "hold"
    fallback: Any = 0.0
    unit: str = ""
    is_opaque: ClassVar[bool] = True

    def ports(self, known: Known) -> Ports:
        """No inputs; the signal (size), its stamp and age [s], packets lost, and 1 while the sender is alive."""
        check_address(self.name, self.host, self.port)
        check_size(self.name, self.size)
        return Ports((), receiver_ports(self.size, self.unit))

    def reaches(self) -> str:
        """The address, if others can reach it."""
        return beyond(self.host, self.port)

    def begin(self) -> None:
        """Listen.

        Raises:
            SymofrosError: Another program listens there, or this machine has no such address.
        """
        listener = socket.socket(socket.AF_INET6 if ":" in self.host else socket.AF_INET, socket.SOCK_DGRAM)
        listener.setblocking(False)
        try:
            listener.bind((self.host, self.port))
        except OSError as error:
            listener.close()
            raise SymofrosError(str(Problem(
                f"block '{self.name}': can't listen at {self.host}:{self.port}", error.strerror or str(error),
                "one program listens at a port of this machine", "choose another port, or end the other program",
            ))) from None  # fmt: skip
        object.__setattr__(self, "_open", (listener, Reception(self.size, self.timeout)))
        object.__setattr__(self, "_began", None)

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Empty the socket, and say what is known now."""
        listener, reception = self.__dict__["_open"]
        if self.__dict__["_began"] is None:
            object.__setattr__(self, "_began", t)
        for _ in range(MAX_TAKEN):
            try:
                data = listener.recv(65536)
            except BlockingIOError:
                break
            except OSError:  # Windows reports here that an earlier packet of ours met no one.
                continue
            reception.take(data, t)
        found: Mapping[str, Any] = reception.outputs(t, self.__dict__["_began"], self.on_silence, self.fallback)
        return found

    def kept(self) -> Mapping[str, Array]:
        """How many packets became what."""
        counts: Mapping[str, Array] = self.__dict__["_open"][1].counts()
        return counts

    def end(self) -> None:
        """Close the socket."""
        self.__dict__["_open"][0].close()


def check_address(name: str, host: str, port: int) -> None:
    """Refuse what is no address.

    Raises:
        DescriptionError: The host is no IP address, or the port none of 1 to 65535.
    """
    try:
        ipaddress.ip_address(host)
    except ValueError:
        raise DescriptionError(Problem(f"block '{name}': no address '{host:.60}'", f"'{host:.60}'",
                                       "a host is an IP address", "127.0.0.1 is this machine")) from None  # fmt: skip
    if not 1 <= port <= 65535:
        raise DescriptionError(Problem(f"block '{name}': no port {port}", f"{port}", "a port is from 1 to 65535",
                                       "choose one above 1023"))  # fmt: skip


def check_size(name: str, size: int) -> None:
    """Refuse signals that no packet holds.

    Raises:
        DescriptionError: Out of 1 to MAX_VALUES.
    """
    if not 1 <= size <= MAX_VALUES:
        raise DescriptionError(Problem(f"block '{name}': {size} values a packet", f"{size}",
                                       f"a packet holds 1 to {MAX_VALUES} values", "send less, or by several blocks"
                                       ))  # fmt: skip


def beyond(host: str, port: int) -> str:
    """The address where it is not this machine's alone; "" where it is."""
    try:
        return "" if ipaddress.ip_address(host).is_loopback else f"{host}:{port}"
    except ValueError:
        return f"{host:.60}:{port}"
