"""Network (section 6.2 of the paper): signals sent to and taken from other programs, by UDP.

Neither waits: a packet that can't be sent now is dropped, and what has not arrived is not waited for. UDP knows no
authentication; both stay on this machine unless their `host` says otherwise.
"""

from __future__ import annotations

import secrets
import socket
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.network.exchange import LOCALHOST, MAX_TAKEN, Exchange, Receiver, Receiving, Transmitter
from symofros.blocks.network.packets import pack
from symofros.diagrams.block import Environment
from symofros.diagrams.external_block import Running
from symofros.errors import SymofrosError


@dataclass(frozen=True, kw_only=True)
class _ByUdp(Exchange):
    port: int
    host: str = LOCALHOST

    def place(self) -> tuple[str, int]:
        """Host and port, as given to the block."""
        return self.host, self.port

    def opened(self) -> socket.socket:
        """A socket of the address's kind, that never waits."""
        made = socket.socket(socket.AF_INET6 if ":" in self.host else socket.AF_INET, socket.SOCK_DGRAM)
        made.setblocking(False)
        return made


@dataclass(frozen=True, kw_only=True)
class UdpTransmitter(_ByUdp, Transmitter):
    """Sends its input at each sample, as one packet (`symofros.blocks.network.packets`).

    What it keeps of a run: "sent" and "dropped", how many packets.

    Attributes:
        port: Port to send to.
        host: Machine to send to; this one by default.
    """

    def begin(self, environment: Environment) -> Running:
        """Open a socket; packets of this run are a stream of their own."""
        return _Sending(self)


class _Sending(Running):
    """Packets of one run."""

    def __init__(self, block: UdpTransmitter) -> None:
        self._to, self._socket = block.place(), block.opened()
        self._stream = secrets.randbits(32)
        self._sent = self._dropped = 0

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Send one packet, or drop it."""
        data = pack(self._stream, self._sent + self._dropped, t, inputs["signal"].reshape(-1))
        try:
            self._socket.sendto(data, self._to)
            self._sent += 1
        except OSError:  # The buffer is full, or nobody is there: the loop goes on.
            self._dropped += 1
        return {}

    def kept(self) -> Mapping[str, Array]:
        """Number of packets sent, and number dropped."""
        return {"sent": np.asarray(float(self._sent)), "dropped": np.asarray(float(self._dropped))}

    def end(self) -> None:
        """Close the socket."""
        self._socket.close()


@dataclass(frozen=True, kw_only=True)
class UdpReceiver(_ByUdp, Receiver):
    """Takes the newest packet that has arrived at each sample, and counts the others.

    What it keeps of a run: "received", "lost", "late", "duplicate", "malformed" and "foreign", how many packets
    (`symofros.blocks.network.packets.Reception`).

    Attributes:
        port: Port to listen at.
        size: Values a packet.
        host: The address to listen at; this machine's own by default.
        timeout: After so long without a packet the sender counts as silent [s].
        on_silence: Then "hold" the last values or give the "value" fallback; "alive" is 0 either way.
        fallback: Values before the first packet, and on silence.
        unit: Unit of the values.
    """

    def begin(self, environment: Environment) -> Running:
        """Listen.

        Raises:
            SymofrosError: Another program, or another run, listens there; or this machine has no such address.
        """
        listener = self.opened()
        try:
            listener.bind(self.place())
        except OSError as error:
            listener.close()
            raise SymofrosError(
                f"block '{self.name}': can't listen at {self.host}:{self.port}",
                error.strerror or str(error),
                "one program, and one run of it at a time, listens at a port of this machine",
                "choose another port, or end the other program or run",
            ) from None
        return _Listening(self, listener)


class _Listening(Receiving):
    """Packets of one run."""

    def __init__(self, block: UdpReceiver, listener: socket.socket) -> None:
        super().__init__(block)
        self._socket = listener

    def arrived(self) -> Iterator[bytes]:
        """Datagrams that wait in the socket, at most MAX_TAKEN."""
        for _ in range(MAX_TAKEN):
            try:
                yield self._socket.recv(65536)
            except BlockingIOError:
                return
            except OSError:  # Windows reports here that an earlier packet of ours met no one.
                continue

    def end(self) -> None:
        """Close the socket."""
        self._socket.close()
