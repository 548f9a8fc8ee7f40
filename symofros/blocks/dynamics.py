"""Dynamics: the mechanism that is simulated, and the efforts that a motion takes (sections 6.2 and 8 of the paper)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from symofros.base.events import Event
from symofros.blocks.checks import refuse
from symofros.blocks.model_function import OFFERED, output_ports, output_values
from symofros.blocks.quantities import WRENCH, frame_ports, motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Terms, Values
from symofros.diagrams.program.variants import FRICTION
from symofros.diagrams.tensor import Tensor, joined
from symofros.errors import DescriptionError, did_you_mean
from symofros.expr import ZERO


@dataclass(frozen=True, kw_only=True)
class ForwardDynamics(Block):
    """A mechanism in motion: efforts in, states, accelerations, friction and constraint forces out.

    Attributes:
        model: Model of the mechanism, whose first state is that of the model.
        perturbed: Frames that external wrenches act on: each adds an input "wrench_FRAME" (force; moment), at the
            frame's origin in world axes [N, N m]; "wrench_link2_tip" for the frame "link2.tip".
        engaged: Whether an input "engaged" says which constraints hold now: 1 or 0, one a constraint, from a sampled
            block. A constraint that engages takes the speeds onto itself as a plastic impact does; one whose frames are
            then more than 1e-3 m or rad apart ends the run.
        events: Events of the mechanism, as `sf.simulate` takes them: name -> formula, or sf.Event with what it sets.
            They come after the model's own; one of the same name stands in its place, and null leaves it out. In place
            of `engaged`, for constraints with switches; inputs are those of `u`.
        functions: Functions of the model that are outputs, too, at the present motion and parameters, such as
            "kinetic_energy", "closure_wrenches", "joint_wrenches", "contact_forces" or "centroidal_momentum": an output
            of that name; where one has several, FUNCTION_OUTPUT each ("contact_forces_gap").
    """

    model: str
    perturbed: tuple[str, ...] = ()
    engaged: bool = False
    events: Mapping[str, Event | str | None] = field(default_factory=dict)
    functions: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no function at a motion."""
        for name in self.functions:
            if name not in OFFERED or OFFERED[name].of_frame:
                known = [offered for offered, row in OFFERED.items() if not row.of_frame]
                rule = f"functions of the whole model at a motion: {', '.join(known)}"
                raise refuse(self.name, f"function '{name}'", name, rule, did_you_mean(name, known) or "leave it out")

    def mechanism(self) -> str:
        """The model."""
        return self.model

    def mechanism_events(self) -> Mapping[str, Event | str | None]:
        """The events."""
        return self.events

    def lock_inputs(self) -> tuple[str, ...]:
        """The input that says which constraints hold."""
        return ("engaged",) if self.engaged else ()

    def ports(self, environment: Environment) -> Ports:
        """Efforts and prescribed motions u (nu); q, v, a, friction (nv), and lam (nc), z (nz) where there are some."""
        record = environment.model(self.model)
        inputs = [motion_port("u", record, "u", record.u_default)]
        for port, frame in frame_ports(self.name, "wrench_", self.perturbed).items():
            environment.frame(self.model, frame)
            inputs.append(Port(port, (6,), "", 0.0, WRENCH))
        names = record.constraint_owners
        if self.engaged:
            if not names:
                raise DescriptionError(
                    f"block '{self.name}': nothing to engage",
                    f"model '{self.model}'",
                    "engaged belongs to a model with constraints",
                    "leave it out, or add a closure",
                )
            inputs.append(Port("engaged", (len(dict.fromkeys(names)),)))
        outputs = [
            motion_port("q", record, "q"),
            motion_port("v", record, "v"),
            motion_port("a", record, "a"),
            motion_port("friction", record, "effort"),
        ]
        outputs += [Port("lam", (record.nc,))] if record.nc else []
        outputs += [Port("z", (len(record.state_names),))] if record.state_names else []
        for function in self.functions:
            shown = output_ports(self.name, function, record)
            outputs += [replace(port, name=name) for port, name in zip(shown, _names_of_outputs(function), strict=True)]
        return Ports(tuple(inputs), tuple(outputs))

    def motion(self, context: EvaluationContext) -> Terms:
        """M v' = r + G^T lam."""
        record, u = context.environment.model(self.model), context.inputs["u"]
        given = {"q": context.q, "v": context.v, "u": u, "t": context.t}
        if not record.nc and not self.perturbed:
            a = context.call(self.model, "forward_dynamics", **given)["a"]
            return Terms(a=a, M=self._mass_matrix(context))
        push = self._push(context)
        if not record.nc:
            outputs = context.call(self.model, "dynamics", **given)
            a = context.solved(outputs["M"], outputs["Q"] - outputs["h"] + push)
            return Terms(a=a, M=self._mass_matrix(context))
        outputs = context.call(self.model, "forward_dynamics", gains=context.gains, **given)
        phi = context.call(self.model, "constraint", q=context.q, u=u, t=context.t)["phi"]
        rate = context.call(self.model, "constraint_rate", q=context.q, v=context.v, u=u, t=context.t)["phi_rate"]
        facing = context.call(self.model, "project", q=context.q, v=context.v, u=u, t=context.t).get("facing")
        G, c = outputs["G"], outputs["c"]
        if self.engaged:
            holds = self._holds(context)
            G, c, phi, rate = G * holds.reshape(-1, 1), c * holds, phi * holds, rate * holds
            if facing is not None:
                first = joined([holds[i] for i in record.facing_conditions])
                facing = facing * first + (1.0 - first)
        return Terms(M=outputs["M"], r=outputs["r"] + push, G=G, c=c, phi=phi, rate=rate, facing=facing)

    def _mass_matrix(self, context: EvaluationContext) -> Tensor | None:
        """M of a mechanism with elastic beams (nv, nv)."""
        if not context.environment.has_elastic_beams(self.model):
            return None
        return context.call(self.model, "mass_matrix", q=context.q, u=context.inputs["u"], t=context.t)["M"]

    def _push(self, context: EvaluationContext) -> Tensor:
        """Generalized forces of the external wrenches (nv)."""
        total = context.numbers([0.0] * len(context.v))
        for port, frame in frame_ports(self.name, "wrench_", self.perturbed).items():
            J = context.call(self.model, "frame_jacobian", frame, q=context.q, u=context.inputs["u"])["J"]
            total = total + J.T @ context.inputs[port]
        return total

    def _holds(self, context: EvaluationContext) -> Tensor:
        """1 for each condition that holds now (nc)."""
        names = context.environment.model(self.model).constraint_owners
        order = list(dict.fromkeys(names))
        return joined([context.inputs["engaged"][order.index(name)] for name in names])

    def compute(self, context: EvaluationContext) -> Values:
        """States, accelerations and forces."""
        record = context.environment.model(self.model)
        nq, nv = len(record.q_names), len(record.v_names)
        motion = {"q": context.q[:nq], "v": context.v[:nv], "a": context.a[:nv]}
        states = {"z": context.v[nv:]} if record.state_names else {}
        signals = {**motion, "friction": friction(context, self.model, motion["q"], motion["v"], **states), **states}
        signals |= {"lam": context.lam} if record.nc else {}
        given = {**motion, **states, "u": context.inputs["u"], "t": context.t}
        for function in self.functions:
            values = output_values(context, self.model, function, "", {**given, "lam": context.lam})
            signals |= {
                name: values[of.name]
                for name, of in zip(_names_of_outputs(function), OFFERED[function].outputs, strict=True)
            }
        return signals


@dataclass(frozen=True, kw_only=True)
class InverseDynamics(Block):
    """The efforts that a motion takes, tau = M a + h - Q(q, v, z, 0), for a tree of joints that all have one.

    States of forces z are an input, from the mechanism or from an observer; it may stay open where no effort depends
    on them.

    Attributes:
        model: Model of the mechanism; a rigid one makes a controller of the paper's kind.
        with_friction: Whether the effort against friction counts; a block of its own compensates it otherwise.
    """

    model: str
    with_friction: bool = True

    def ports(self, environment: Environment) -> Ports:
        """Motion in: q (nq), v and a (nv), z (nz) where there are some. Efforts out: tau (nv)."""
        record = environment.model(self.model)
        motion = tuple(motion_port(name, record, name) for name in ("q", "v", "a"))
        states = (Port("z", (len(record.state_names),), "", 0.0),) if record.state_names else ()
        return Ports(motion + states, (motion_port("tau", record, "effort"),))

    def compute(self, context: EvaluationContext) -> Values:
        """Efforts tau by inverse dynamics of the model, without those against friction if `with_friction` is False."""
        q, v, a = (context.inputs[name] for name in ("q", "v", "a"))
        # An open input is zeros: it is left out, so that efforts that depend on it are refused.
        states = {name: z for name, z in context.inputs.items() if name == "z" and any(edge != ZERO for edge in z.flat)}
        tau = context.call(self.model, "inverse_dynamics", q=q, v=v, a=a, t=context.t, **states)["tau"]
        return {"tau": tau if self.with_friction else tau + friction(context, self.model, q, v, **states)}


def friction(context: EvaluationContext, model: str, q: Tensor, v: Tensor, **states: Tensor) -> Tensor:
    """The friction forces on a model's joints (nv), as generalized forces: against the motion.

    Args:
        context: Where they are written.
        model: The model.
        q: Its configuration (nq).
        v: Its speeds (nv).
        states: z (nz), where its forces have states.
    """
    has_friction = context.environment.has_friction(model)
    if not any(has_friction):
        return context.numbers([0.0] * len(has_friction))
    given = {"q": q, "v": v, "t": context.t}
    if states and (needed := context.environment.model(model + FRICTION).state_names):
        names = context.environment.model(model).state_names
        given["z"] = joined([states["z"][names.index(name)] for name in needed])
    force = context.call(model + FRICTION, "generalized_force", **given)["Q"]
    return force * [float(rubs) for rubs in has_friction]


def _names_of_outputs(function: str) -> list[str]:
    """Names of the ports of a function's outputs."""
    outputs = OFFERED[function].outputs
    return [function] if len(outputs) == 1 else [f"{function}_{output.name}" for output in outputs]
