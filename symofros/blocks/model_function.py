"""Any function of a model as a block: energies, momentum, wrenches of joints, forces of contacts, mass matrix, ..."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import prod

from symofros.base.functions import FUNCTIONS
from symofros.blocks.checks import refuse
from symofros.blocks.quantities import Quantity, motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, joined, stacked
from symofros.errors import did_you_mean
from symofros.runtime.record import ModelRecord

# Inputs that a block can be given, and those of motion; functions with others are not offered.
_MOTION: dict[str, Quantity] = {"q": "q", "v": "v", "a": "a", "u": "u"}
_INPUTS = {*_MOTION, "lam", "t"}
# Functions whose terms are theirs alone; those of solvers are blocks by themselves (`ForwardDynamics`).
OFFERED = {
    name: row
    for name, row in FUNCTIONS.items()
    if {*row.inputs} <= _INPUTS and not row.by_solver and not any("nb" in size for o in row.outputs for size in o.shape)
}


@dataclass(frozen=True, kw_only=True)
class ModelFunction(Block):
    """A function of a model at a motion, by its name in the table of functions.

    Attributes:
        model: The model.
        function: Name of the function, such as "kinetic_energy", "joint_wrenches" or "contact_forces".
        frame: Frame of a function of frames.
    """

    model: str
    function: str
    frame: str = ""

    def __post_init__(self) -> None:
        """Refuse functions that are not offered, and frames where they mean nothing."""
        if self.function not in OFFERED:
            rule = f"a function of q, v, a, u, lam and t that no solver finishes: {', '.join(OFFERED)}"
            remedy = "ForwardDynamics gives accelerations and multipliers"
            remedy = remedy if self.function in FUNCTIONS else did_you_mean(self.function, OFFERED)
            raise refuse(self.name, f"no function '{self.function}'", self.function, rule, remedy)
        if bool(self.frame) != OFFERED[self.function].of_frame:
            stated, rule = self.frame or "no frame", "functions of frames have one, others none"
            raise refuse(self.name, f"frame of '{self.function}'", stated, rule, "state it, or leave it out")

    def ports(self, environment: Environment) -> Ports:
        """The inputs of the function but the time, states of forces z, zero but for q if not connected; its outputs."""
        record, row = environment.model(self.model), OFFERED[self.function]
        if self.frame:
            environment.frame(self.model, self.frame)
        outputs = output_ports(self.name, self.function, record)
        groups = [*row.inputs, *(["u"] if record.driven and "u" not in row.inputs else [])]
        groups += ["lam"] if _reads_reactions(self.function, record) else []
        inputs = [_input(group, record) for group in groups if group != "t" and _entries(group, record)]
        if _reads_reactions(self.function, record):
            inputs[-1] = replace(inputs[-1], default=None)
        if record.state_names:
            inputs.append(Port("z", (len(record.state_names),), "", 0.0))
        return Ports(tuple(inputs), outputs)

    def compute(self, context: EvaluationContext) -> Values:
        """The function at the inputs."""
        none = {"u": context.numbers([]), "lam": context.numbers([])}
        record = context.environment.model(self.model)
        given = {name: signal for name, signal in none.items() if not _entries(name, record)}
        given |= {"t": context.t, **context.inputs}
        return output_values(context, self.model, self.function, self.frame, given)


def output_ports(block: str, function: str, record: ModelRecord) -> tuple[Port, ...]:
    """Ports of the outputs of an offered function.

    Raises:
        DescriptionError: The model has nothing that the function tells of.
    """
    row = OFFERED[function]
    if row.constrained_only and not record.nc:
        rule, remedy = "it is a function of constraints", "choose a model with constraints"
        raise refuse(block, f"'{function}' of a tree", record.name, rule, remedy)
    outputs = tuple(Port(output.name, output.sizes(_sizes(record))) for output in row.outputs)
    if not any(prod(port.shape or ()) for port in outputs):
        rule, remedy = "what it tells of is in the model", "choose a model that has some"
        raise refuse(block, f"'{function}' has no entries", record.name, rule, remedy)
    return outputs


def output_values(at: EvaluationContext, model: str, function: str, frame: str, given: Mapping[str, Tensor]) -> Values:
    """Outputs of an offered function; forces of rigid contacts are those of their multipliers."""
    record = at.environment.model(model)
    found = at.call(model, function, frame, **given)
    outputs = {output.name: found[output.name] for output in OFFERED[function].outputs}
    if not _reads_reactions(function, record):
        return outputs
    lam, places = given["lam"], {name: i for i, name in enumerate(record.wrench_names)}
    wrenches = at.call(model, "closure_wrenches", "", **given)["on_second"]
    push, force = list(outputs["push"]), list(outputs["force"])
    for ball in record.rigid_contacts:
        k = record.contact_names.index(ball.name)
        normal, across = (wrenches[places[name]][:3] for name in ball.constraints)
        push[k], force[k] = lam[ball.rows[2]], normal + across
    return outputs | {"push": joined(push), "force": stacked(force)}


def _reads_reactions(function: str, record: ModelRecord) -> bool:
    """Whether a function tells of forces of rigid contacts, which are multipliers."""
    return function == "contact_forces" and bool(record.rigid_contacts)


def _entries(group: str, record: ModelRecord) -> int:
    return record.nc if group == "lam" else len(record.vectors["v" if group == "a" else group])


def _input(group: str, record: ModelRecord) -> Port:
    if group == "lam":
        return Port("lam", (record.nc,), "", 0.0)
    default = {"q": None, "u": record.u_default}.get(group, 0.0)
    return motion_port(group, record, _MOTION[group], default)


def _sizes(record: ModelRecord) -> dict[str, int]:
    """Sizes that shapes of outputs are stated in."""
    named = {
        "nq": record.q_names,
        "nv": record.v_names,
        "nu": record.u_names,
        "nc": record.constraint_names,
        "npar": record.par_names,
        "nw": record.wrench_names,
        "nj": record.joint_names,
        "nf": record.section_names,
        "ns": record.prescribed_names,
        "nk": record.contact_names,
    }
    return {size: len(names) for size, names in named.items()} | {"npi": 10 * len(record.link_names)}
