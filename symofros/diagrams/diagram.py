"""A diagram as its author states it: models, blocks, and what joins them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from symofros.base.arguments import CheckedCalls, checked
from symofros.base.arrays import real_array
from symofros.description import System
from symofros.diagrams.block import Block, ModelFile, ModelSetup, Port
from symofros.diagrams.conditional import LEVEL, ON, SIGNAL, Condition, OnCondition
from symofros.diagrams.enabled import Enabled, on_condition
from symofros.diagrams.program.variants import with_functions
from symofros.diagrams.settings import RunSettings
from symofros.errors import DescriptionError, Problem, did_you_mean

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*$")
INSIDE = "/"


@dataclass(frozen=True)
class Part:
    """A diagram inside another, as it was put there.

    Attributes:
        diagram: Included diagram.
        models: Name of a model in the included diagram -> name in the including one.
        inputs: Inlet -> source.
        condition: When it runs; None: always.
        parameters: Run-time parameter of the included diagram -> value, where another than there.
    """

    diagram: Diagram
    models: Mapping[str, str]
    inputs: Mapping[str, str]
    condition: Condition | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)


@dataclass
class Diagram(metaclass=CheckedCalls):
    """Blocks and wires; a system of equations once `sf.compile_diagram` has read it.

    Attributes:
        name: Name.
        models: Name -> model, which blocks refer to; exchanging one exchanges it for all of them.
        blocks: Name -> block, in the order of addition.
        wires: (block, input port) -> source, as "block.port" or "block" where that has one output.
        inlets: Inputs from outside, where the diagram is part of another, is exported or is run with `inputs`: name ->
            input ports "block.port", or inlets "part.inlet" of parts, that it feeds.
        outlets: Outputs to the outside: name -> "block.port" that it is read from.
        inlet_ports: Inlet -> its shape, units and start (`default`), where the inputs that it feeds do not say them.
        simulation: Settings of a run, as its author stated them.
        parts: Name -> what was included, for those who write the diagram down again.
        origin: ("block", name), ("input", block, port), ("model", name), ("inlet", name) or ("outlet", name) ->
            "file:line" of what came from a file.
        file: File that it was read from; "" for none.
    """

    name: str
    models: dict[str, ModelSetup] = field(default_factory=dict)
    blocks: dict[str, Block] = field(default_factory=dict)
    wires: dict[tuple[str, str], str] = field(default_factory=dict)
    inlets: dict[str, Sequence[str]] = field(default_factory=dict)
    outlets: dict[str, str] = field(default_factory=dict)
    inlet_ports: dict[str, Port] = field(default_factory=dict)
    simulation: RunSettings = field(default_factory=RunSettings)
    parts: dict[str, Part] = field(default_factory=dict)
    origin: dict[tuple[str, ...], str] = field(default_factory=dict, compare=False)
    file: str = field(default="", compare=False)

    def where(self, block: str, port: str = "") -> str:
        """The "file:line" of an input, or else of its block; "" if they are stated in Python."""
        return self.origin.get(("input", block, port)) or self.origin.get(("block", block), "")

    @checked
    def add_model(
        self,
        name: str,
        system: System,
        start: Mapping[str, float] | None = None,
        parameters: Mapping[str, float] | None = None,
        functions: int | None = None,
        file: ModelFile | None = None,
    ) -> None:
        """State a model.

        Args:
            name: Name by which blocks refer to it.
            system: The description.
            start: Coordinate, or d and a speed's name -> first value.
            parameters: Run-time parameters that differ from the description's.
            functions: Shape functions in each direction that beams have any in; 0: the equivalent rigid mechanism.
            file: File that the description was read from, stated when the diagram is saved.
        """
        self._refuse_name("model", name, self.models)
        stated = system if functions is None else with_functions(system, functions)
        self.models[name] = ModelSetup(stated, dict(start or {}), dict(parameters or {}), file)

    @checked
    def add(self, block: Block, **inputs: str) -> Block:
        """Add a block, its inputs fed by `port="block.port"`.

        Raises:
            DescriptionError: The name is taken or no name.
        """
        self._refuse_name("block", block.name, self.blocks)
        self.blocks[block.name] = block
        for port, source in inputs.items():
            self.connect(source, f"{block.name}.{port}")
        return block

    @checked
    def connect(self, source: str, target: str) -> None:
        """Join an output, "block.port", to an input, "block.port".

        Raises:
            DescriptionError: The input is fed already, or is written wrong.
        """
        block, _, port = target.rpartition(".")
        if not block or not port:
            raise DescriptionError(
                f"diagram '{self.name}': no input '{target}'",
                "no block and port",
                "an input is written block.port",
                "for example pd.desired",
            )
        if (block, port) in self.wires:
            raise DescriptionError(
                f"diagram '{self.name}': input '{target}' is fed twice",
                f"by {self.wires[block, port]} and {source}",
                "an input has one source",
                "add the signals in a block of their own",
            )
        self.wires[block, port] = source

    @checked
    def add_inlet(
        self, name: str, *targets: str, shape: tuple[int, ...] | None = None, unit: str = "", start: Any = None
    ) -> None:
        """State an input from outside.

        Args:
            name: Name of the signal.
            targets: Inputs "block.port", or inlets "part.inlet" of parts, that it feeds.
            shape: Its shape, () for one number; None: that of an input that it feeds.
            unit: Its unit; "": that of an input that it feeds.
            start: First values of exports; None: defaults of inputs that it feeds, or zero.

        Raises:
            DescriptionError: The name is taken or no name.
        """
        self._refuse_name("inlet", name, self.inlets)
        self.inlets[name] = targets
        if (shape, unit, start) != (None, "", None):
            self.inlet_ports[name] = Port(name, shape, unit, start)

    @checked
    def include(
        self,
        name: str,
        part: Diagram,
        models: Mapping[str, str] | None = None,
        condition: Condition | None = None,
        parameters: Mapping[str, Any] | None = None,
        **inputs: str,
    ) -> None:
        """Put a diagram into this one: its blocks become "name/block", its outlets "name.outlet".

        Args:
            name: Name of the part.
            part: A diagram with inlets and outlets.
            models: The part's name of a model -> this diagram's; models that are left out come along as "name/model".
            condition: When its blocks run; None: always.
            parameters: Run-time parameter of the part, as "block.gain" or "model.mass" -> its value here.
            inputs: Inlet -> source.

        Raises:
            DescriptionError: An inlet or a parameter is unknown, a name is taken, or a block can't run on a condition.
        """
        self._refuse_name("part", name, {block.split(INSIDE)[0] for block in self.blocks})
        outlets = part.outlet_sources()
        values, known = dict(parameters or {}), dict(models or {})
        own = {inner: setup for inner, setup in part.models.items() if inner not in known}
        inside, own = self._valued(name, part.blocks, own, values)
        if condition is not None:
            inside = self._conditional(name, inside, condition, outlets)
        self.parts[name] = Part(part, dict(known), dict(inputs), condition, values)
        for inner, setup in own.items():
            known[inner] = f"{name}{INSIDE}{inner}"
            self.models[known[inner]] = setup
        for block in inside.values():
            self.blocks[f"{name}{INSIDE}{block.name}"] = _renamed(block, name, known)
        for (block_name, port), source in part.wires.items():
            self.wires[f"{name}{INSIDE}{block_name}", port] = f"{name}{INSIDE}{outlets.get(source, source)}"
        if condition is not None:
            self._connect_condition(name, condition, inside)
        for inlet, source in inputs.items():
            self._feed(name, part, inlet, source)
        for outlet, source in outlets.items():
            self.outlets[f"{name}.{outlet}"] = f"{name}{INSIDE}{source}"
        for (kind, first, *rest), line in part.origin.items():
            inside_name = f"{name}.{first}" if kind == "outlet" else f"{name}{INSIDE}{first}"
            self.origin[kind, inside_name, *rest] = line

    def _conditional(
        self, part: str, blocks: Mapping[str, Block], condition: Condition, outlets: Mapping[str, str]
    ) -> dict[str, Block]:
        """A part's blocks as they run on its condition."""
        try:
            return dict(on_condition(blocks, condition, outlets))
        except DescriptionError as error:
            part_of = f"diagram '{self.name}': part '{part}': "
            raise DescriptionError([replace(one, what=part_of + one.what) for one in error.problems]) from None

    def _valued(
        self, part: str, blocks: Mapping[str, Block], models: Mapping[str, ModelSetup], values: Mapping[str, Any]
    ) -> tuple[dict[str, Block], dict[str, ModelSetup]]:
        """Blocks and models of a part with other values of some run-time parameters."""
        blocks, models, problems = dict(blocks), dict(models), list[Problem]()
        of_blocks = {f"{name}.{key}": (name, key) for name, block in blocks.items() for key in block.parameters()}
        of_models = {
            f"{name}.{key}": (name, key) for name, one in models.items() for key in one.system.parameter_values()
        }
        stated: dict[tuple[bool, str], dict[str, Any]] = {}
        what = f"diagram '{self.name}': part '{part}': "
        for name, value in values.items():
            array, is_of_block = real_array(value), name in of_blocks  # As runs take a name that a model has, too.
            if not is_of_block and name not in of_models:
                known = [*of_blocks, *of_models]
                rule = f"run-time parameters of the part and its own models: {', '.join(known[:12]) or 'none'}"
                remedy = did_you_mean(name, known)
                problems.append(Problem(f"{what}no parameter '{name:.60}'", f"'{name:.60}'", rule, remedy))
            elif array is None or not np.isfinite(array).all() or (not is_of_block and array.ndim):
                rule = "finite; one number, of a model"
                problems.append(Problem(f"{what}parameter '{name}'", f"{value!r:.60}", rule, "such as 0.5"))
            else:
                owner, key = (of_blocks if is_of_block else of_models)[name]
                stated.setdefault((is_of_block, owner), {})[key] = array.tolist()
        for (is_of_block, owner), given in stated.items():
            if not is_of_block:
                models[owner] = replace(models[owner], parameters={**models[owner].parameters, **given})
                continue
            try:
                blocks[owner] = blocks[owner].with_parameters(given)
            except DescriptionError as error:
                problems += [replace(one, what=what + one.what) for one in error.problems]
        if problems:
            raise DescriptionError(problems)
        return blocks, models

    def _feed(self, name: str, part: Diagram, inlet: str, source: str) -> None:
        """Connect a source to all that an inlet of a part feeds."""
        if inlet not in part.inlets:
            raise DescriptionError(
                f"diagram '{self.name}': part '{name}' has no inlet '{inlet}'",
                f"'{inlet}'",
                f"inlets: {', '.join(part.inlets) or 'none'}",
                did_you_mean(inlet, part.inlets),
            )
        for target in part.fed_by(inlet):
            self.connect(source, f"{name}{INSIDE}{target}")

    def _connect_condition(self, part: str, condition: Condition, blocks: Mapping[str, Block]) -> None:
        """Feed what tells the signals of a part's condition, and by it the part's blocks."""
        for signal, by in condition.signals().items():
            for block in blocks.values():
                if isinstance(block, OnCondition):
                    output = LEVEL if isinstance(block, Enabled) else ON
                    self.wires[f"{part}{INSIDE}{block.name}", block.inputs[signal]] = f"{part}{INSIDE}{signal}.{output}"
            if isinstance(by, str):
                self.connect(by, f"{part}{INSIDE}{signal}.{SIGNAL}")

    def fed_by(self, inlet: str) -> list[str]:
        """Inputs "block.port" that an inlet feeds, of parts by their inlets and the signals of their conditions."""
        targets, inputs = self.inlets[inlet], list[str]()
        for target in [targets] if isinstance(targets, str) else targets:
            name, _, port = target.rpartition(".")
            part = self.parts.get(name)
            if part is not None and port in part.diagram.inlets:
                inputs += [f"{name}{INSIDE}{one}" for one in part.diagram.fed_by(port)]
            elif part is not None and part.condition is not None and port in part.condition.signals():
                inputs.append(f"{name}{INSIDE}{port}.{SIGNAL}")
            else:
                inputs.append(target)
        return inputs

    def outlet_sources(self) -> dict[str, str]:
        """Outlet -> "block.port" or "block", of its own and of all parts, whether `outlets` names these or not."""
        of_parts = {
            f"{name}.{outlet}": f"{name}{INSIDE}{source}"
            for name, part in self.parts.items()
            for outlet, source in part.diagram.outlet_sources().items()
        }
        sources: dict[str, str] = {}
        for name, source in self.outlets.items():
            sources[name] = sources.get(source, of_parts.get(source, source))
        return {**sources, **{name: source for name, source in of_parts.items() if name not in sources}}

    @checked
    def with_model(self, name: str, setup: ModelSetup) -> Diagram:
        """The same diagram about another model: rigid in place of flexible, say."""
        if name not in self.models:
            raise DescriptionError(
                f"diagram '{self.name}': no model '{name}'",
                f"'{name}'",
                f"models: {', '.join(self.models) or 'none'}",
                did_you_mean(name, self.models),
            )
        return replace(self, models={**self.models, name: setup})

    def _refuse_name(self, what: str, name: str, taken: Any) -> None:
        if not _NAME.match(name):
            raise DescriptionError(
                f"diagram '{self.name}': {what} '{name:.60}'",
                "not a name",
                "letters, digits and underscores, a letter first",
                "rename it",
            )
        if name in taken:
            raise DescriptionError(
                f"diagram '{self.name}': two {what}s named '{name}'", f"'{name}'", "names are unique", "rename one"
            )


def _renamed(block: Block, part: str, models: Mapping[str, str]) -> Block:
    changes: dict[str, Any] = {"name": f"{part}{INSIDE}{block.name}"}
    if isinstance(block, OnCondition):
        changes["block"] = _renamed(block.block, part, models)
    model = getattr(block, "model", None)
    if isinstance(model, str) and model in models:
        changes["model"] = models[model]
    return replace(block, **changes)
