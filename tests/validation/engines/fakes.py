"""Plug-ins that behave badly: Pinocchio's, each with one fault of a stranger's; a package of its own in tests."""

from __future__ import annotations

import math
import os
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from validation.engines.documented import PAGE
from validation.engines.interface import Slot, State, Tree
from validation.engines.plugins import OWN

RIGHT = OWN["pinocchio"]


class Model:
    """Pinocchio's model with other calls and scripts."""

    def __init__(self, model: Any, plugin: Plugin) -> None:
        self._model, self._plugin = model, plugin
        self.nq, self.nv, self.slots = model.nq, model.nv, plugin.slots or model.slots

    def call(self, function: str, state: State) -> Any:
        return self._plugin.answer(self._model.call(function, state))

    def script(self, function: str, state: State) -> str:
        return self._plugin.text(self._model.call(function, state))


class Plugin:
    """Pinocchio's plug-in, two functions of it."""

    package, extra, kinds, gravity, formats, slacks = RIGHT.package, RIGHT.extra, {}, (), (), {}
    conventions = (("joints", "Pinocchio's"),)

    def __init__(
        self,
        name: str,
        answer: Callable[[Any], Any] = lambda value: value,
        text: Callable[[Any], str] = lambda value: "",
        begun: Callable[[], object] = lambda: None,
        slots: Any = (),
        functions: tuple[str, ...] = ("mass_matrix", "gravity"),
    ) -> None:
        self.name, self.answer, self.text, self.begun, self.slots = name, answer, text, begun, slots
        self.functions = {one: one for one in functions}

    def version(self) -> str:
        return RIGHT.version()

    def build(self, tree: Tree) -> Any:
        self.begun()
        return Model(RIGHT.build(tree), self)

    def read(self, tree: Tree, form: str, text: str) -> Any:
        raise NotImplementedError


def wrong(value: Any) -> Any:
    """Off by more than rounding."""
    return value + 1.0


def fault(*_: object) -> Any:
    raise KeyError("no joint 7")


def leaves(*_: object) -> Any:
    sys.exit(3)


def starred(value: Any) -> str:
    """A script that gets the wrong answer by names that a star brings."""
    return f"import numpy as np\nfrom math import *\nvalue = np.array({value.tolist()!r}) + sqrt(1.0)"


PLUGINS = {
    plugin.name: plugin
    for plugin in (
        Plugin("silent", wrong),
        Plugin("starred", wrong, starred),
        Plugin("bare", wrong, lambda value: f"value = {wrong(value).tolist()!r}"),
        Plugin("unproven", wrong, lambda value: f"value = {value.tolist()!r}"),
        Plugin("torn", wrong, lambda value: "value = ("),
        Plugin("unbuilt", begun=fault),
        Plugin("uncalled", fault),
        Plugin("unwritten", wrong, fault),
        Plugin("textual", lambda value: "seven"),
        Plugin("misplaced", slots=((), ())),
        Plugin("slotless", slots=((), (), ())),
        Plugin("uncharted", slots=((Slot("angel", (0,), (0,)),),) * 3),
        Plugin("beyond", slots=((Slot("angle", (3,), (0,)),),) * 3),
        Plugin("leaving", leaves),
        Plugin("unnumbered", lambda value: value * math.nan),
    )
}
# What ends a process, or does not end.
DEADLY = {
    plugin.name: plugin
    for plugin in (Plugin("dying", lambda value: os.abort()), Plugin("hanging", lambda value: time.sleep(60)))
}
# What is no plug-in, by the contract.
REFUSED = {"empty": object(), "unknown": Plugin("unknown", functions=("mass_metrix",)), "other": Plugin("another")}


def install(folder: Path) -> None:
    """A package in a folder whose entry points are all of these."""
    text = "from tests.validation.engines.fakes import DEADLY, PLUGINS, REFUSED\n"
    text += "globals().update(PLUGINS | DEADLY | REFUSED)\n"
    _package(folder, "fake_engines", text, {name: name for name in (*PLUGINS, *DEADLY, *REFUSED, "absent")})


def install_toy(folder: Path) -> str:
    """The toy of docs/engines.md as a package in a folder; the program there that asks it."""
    plugin, program = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    _package(folder, "toy_engine", plugin, {"toy": "PLUGIN"})
    return str(program)


def _package(folder: Path, module: str, text: str, points: dict[str, str]) -> None:
    """A distribution of one module that offers plug-ins: name -> name in the module."""
    (folder / f"{module}.py").write_text(text)
    info = folder / f"{module}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {module.replace('_', '-')}\nVersion: 1.0\n")
    stated = "".join(f"{name} = {module}:{place}\n" for name, place in points.items())
    (info / "entry_points.txt").write_text(f"[symofros.engines]\n{stated}")
