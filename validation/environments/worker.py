"""Races in one environment, in a process of its own.

The messages of `work` are a kind and a value: a "row", an "absent" side, what has "failed", a package's "version", and
"doing" of what comes next.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from functools import partial
from importlib import import_module, metadata

from ..reporting.numbers import counted
from ..timing.worker import Message
from . import in_node, race
from .in_casadi import CASADI
from .in_jax import JAX
from .in_torch import TORCH
from .record import OURS, Absent, Row
from .sides import Environment, Offer, Peer, Subject

ENVIRONMENTS = {one.name: one for one in (JAX, TORCH, CASADI)}


def work(name: str, models: Sequence[str], states: Sequence[int], turns: int) -> Iterator[Message]:
    """Race all functions of an environment, on each model with each number of states in a call."""
    return (_race_in_node if name == in_node.NAME else _race)(name, models, states, turns)


def _race(name: str, models: Sequence[str], states: Sequence[int], turns: int) -> Iterator[Message]:
    environment = ENVIRONMENTS[name]
    missing = _missing(environment.own)
    if missing:
        yield "absent", Absent(name, OURS, missing, environment.own.install)
        return
    yield "version", _version(environment.own)
    present = yield from _present(environment)
    for label in models:
        yield "doing", (label, "compiling")
        subject = Subject.of(label, max(states))
        offers = yield from _offers(environment, subject, (environment.own, *present))
        for function in environment.functions:
            for count in states:
                yield "doing", (label, f"{function}, {counted(count, 'state')}")
                rows = partial(race.rows, name, subject, offers, function, count, turns)
                yield from _messages(name, function, rows)


def _race_in_node(name: str, models: Sequence[str], states: Sequence[int], turns: int) -> Iterator[Message]:
    """The functions of each model in WebAssembly, run by Node, as `_race` does for other environments."""
    missing = in_node.missing()
    if missing is not None:
        yield "absent", missing
        return
    for label in models:
        yield "doing", (label, "compiling and racing in Node")
        subject = Subject.of(label, max(states))
        ran = in_node.run(subject, states, turns)
        yield "version", ("node", ran["node"].removeprefix("v"))
        if ran["mujoco"]:
            yield "version", (in_node.PEER, ran["mujoco"])
        for one in ran["races"]:
            yield from _messages(name, one["function"], partial(in_node.rows, subject, one, turns))
    if not ran["mujoco"]:
        yield "absent", Absent(name, in_node.PEER, "Node finds no such package", in_node.INSTALL_PEER)


def _messages(name: str, function: str, rows: Callable[[race.Fail], Iterator[Row]]) -> Iterator[Message]:
    """The rows of one race, and the sides that it has left out, which are known at its end."""
    failed: list[tuple[str, str, str, str]] = []
    for row in rows(lambda who, reason: failed.append((name, function, who, reason))):
        yield "row", row
    for said in failed:
        yield "failed", said


def _missing(peer: Peer) -> str:
    """Why a package does not import; "" where it does."""
    try:
        import_module(peer.module)
    except Exception as problem:  # A package may fail in its own ways as it loads.
        return f"{peer.module} is not installed" if isinstance(problem, ModuleNotFoundError) else str(problem)
    return ""


def _version(peer: Peer) -> tuple[str, str]:
    return peer.package, metadata.version(peer.package)


def _present(environment: Environment) -> Generator[Message, None, list[Peer]]:
    """The peers that are installed; one that takes part in several ways is missed once."""
    missed, present = set(), []
    for peer in environment.peers:
        missing = _missing(peer)
        if not missing:
            yield "version", _version(peer)
            present.append(peer)
        elif peer.module not in missed:
            missed.add(peer.module)
            yield "absent", Absent(environment.name, peer.name.partition(",")[0], missing, peer.install)
    return present


def _offers(
    environment: Environment, subject: Subject, sides: tuple[Peer, ...]
) -> Generator[Message, None, list[tuple[str, Offer]]]:
    """Each side that can read the model, with what makes its functions."""
    offers = []
    for side in sides:
        try:
            offers.append((side.name, side.offer(subject)))
        except Exception as problem:  # Readers raise errors of every kind.
            what = f"all functions of {subject.label}"
            yield "failed", (environment.name, what, side.name, f"{type(problem).__name__}: {problem}")
    return offers
