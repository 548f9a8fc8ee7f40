"""Races in one environment, in a process of its own: `python -m validation.environments.worker`.

Arguments: a job as JSON, {"environment", "models", "states", "turns"}. Prints a JSON object a line: {"row": ...},
{"absent": ...}, {"failed": ...}, {"version": ...} of a package, {"doing": ...} of what comes next.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from importlib import import_module, metadata

from ..reporting.numbers import counted
from ..timing.processes import Say, say
from . import in_node
from .in_casadi import CASADI
from .in_jax import JAX
from .in_torch import TORCH
from .race import rows
from .record import OURS, Absent
from .sides import Environment, Offer, Peer, Subject

ENVIRONMENTS = {one.name: one for one in (JAX, TORCH, CASADI)}


def work(environment: Environment, models: list[str], states: list[int], turns: int, say: Say) -> None:
    """Race all functions of an environment, on each model with each number of states in a call."""
    missing = _missing(environment.own)
    if missing:
        say("absent", asdict(Absent(environment.name, OURS, missing, environment.own.install)))
        return
    say("version", _version(environment.own))
    present = list(_present(environment, say))
    for label in models:
        say("doing", [label, "compiling"])
        subject = Subject.of(label, max(states))
        offers = list(_offers(environment, subject, (environment.own, *present), say))
        for function in environment.functions:
            for count in states:
                say("doing", [label, f"{function}, {counted(count, 'state')}"])
                fail = partial(_fail, say, environment.name, function)
                for row in rows(environment.name, subject, offers, function, count, turns, fail):
                    say("row", asdict(row))


def run_node_worker(models: list[str], states: list[int], turns: int, say: Say) -> None:
    """Race the functions of each model in WebAssembly, run by Node, as `work` does for other environments."""
    missing = in_node.missing()
    if missing is not None:
        say("absent", asdict(missing))
        return
    for label in models:
        say("doing", [label, "compiling and racing in Node"])
        subject = Subject.of(label, max(states))
        ran = in_node.run(subject, states, turns)
        say("version", ["node", ran["node"].removeprefix("v")])
        if ran["mujoco"]:
            say("version", [in_node.PEER, ran["mujoco"]])
        for race in ran["races"]:
            fail = partial(_fail, say, in_node.NAME, race["function"])
            for row in in_node.rows(subject, race, turns, fail):
                say("row", asdict(row))
    if not ran["mujoco"]:
        missing = Absent(in_node.NAME, in_node.PEER, "Node finds no such package", in_node.INSTALL_PEER)
        say("absent", asdict(missing))


def _fail(say: Say, environment: str, function: str, who: str, reason: str) -> None:
    say("failed", [environment, function, who, reason])


def _missing(peer: Peer) -> str:
    """Why a package does not import; "" where it does."""
    try:
        import_module(peer.module)
    except Exception as problem:  # A package may fail in its own ways as it loads.
        return f"{peer.module} is not installed" if isinstance(problem, ModuleNotFoundError) else str(problem)
    return ""


def _version(peer: Peer) -> tuple[str, str]:
    return peer.package, metadata.version(peer.package)


def _present(environment: Environment, say: Say) -> Iterator[Peer]:
    """The peers that are installed; one that takes part in several ways is missed once."""
    told = set()
    for peer in environment.peers:
        missing = _missing(peer)
        if missing:
            if peer.module not in told:
                told.add(peer.module)
                say("absent", asdict(Absent(environment.name, peer.name.partition(",")[0], missing, peer.install)))
        else:
            say("version", _version(peer))
            yield peer


def _offers(
    environment: Environment, subject: Subject, sides: tuple[Peer, ...], say: Say
) -> Iterator[tuple[str, Offer]]:
    """Each side that can read the model, with what makes its functions."""
    for side in sides:
        try:
            yield side.name, side.offer(subject)
        except Exception as problem:  # Readers raise errors of every kind.
            say(
                "failed",
                [
                    environment.name,
                    f"all functions of {subject.label}",
                    side.name,
                    f"{type(problem).__name__}: {problem}",
                ],
            )


if __name__ == "__main__":
    job = json.loads(sys.argv[1])
    asked = job["models"], job["states"], job["turns"], say
    if job["environment"] == in_node.NAME:
        run_node_worker(*asked)
    else:
        work(ENVIRONMENTS[job["environment"]], *asked)
