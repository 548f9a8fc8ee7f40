"""Points, vectors, velocities and wrenches in other frames; orientations in other forms, and their difference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from symofros.blocks.checks import choice
from symofros.blocks.quantities import NO_UNIT, VELOCITY, WRENCH, motion_port, passed_units, with_units
from symofros.blocks.rotations import (
    EULER,
    error_vector,
    euler_of_matrix,
    length,
    matrix_of_euler,
    matrix_of_quaternion,
    matrix_of_vector,
    quaternion_of_matrix,
    vector_of_matrix,
)
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Shape, Values
from symofros.diagrams.tensor import Tensor, joined

QUANTITIES = ("point", "vector", "velocity", "wrench")


def transformed(quantity: str, p: Tensor, R: Tensor, u: Tensor) -> Tensor:
    """A quantity of frame B, seen in frame A.

    Args:
        quantity: point (3); vector (3); velocity (linear; angular) and wrench (force; moment), which are also taken
            from the origin of B to that of A, as those of one rigid body.
        p: Origin of B in A (3).
        R: R_AB (3, 3).
        u: Vector in B.
    """
    if quantity == "point":
        return p + R @ u
    if quantity == "vector":
        return R @ u
    first, second = R @ u[:3], R @ u[3:]
    if quantity == "velocity":
        return joined([first + p.cross(second), second])
    return joined([first, second + p.cross(first)])


def _size(quantity: str) -> Shape:
    return (3,) if quantity in ("point", "vector") else (6,)


def _units(environment: Environment, quantity: str) -> tuple[str, ...]:
    """Units of a point, velocity or wrench; a vector keeps its own."""
    known = {"point": ("m",), "velocity": VELOCITY, "wrench": WRENCH}
    return known.get(quantity) or passed_units(environment, "", ["u"])


@dataclass(frozen=True, kw_only=True)
class Transform(Block):
    """A point, vector, velocity or wrench of frame B in the axes, and about the origin, of A; or back.

    Attributes:
        quantity: point, vector, velocity or wrench.
        inverse: Whether it goes from A to B.
    """

    quantity: str = "point"
    inverse: bool = False

    def __post_init__(self) -> None:
        """A known quantity."""
        choice(self.name, "quantity", self.quantity, QUANTITIES)

    def ports(self, environment: Environment) -> Ports:
        """Inputs p (3), the origin of B in A, R_AB (3, 3), u; output y."""
        of = _units(environment, self.quantity)
        size = _size(self.quantity)
        pose = Port("p", (3,), "m", 0.0), Port("R", (3, 3), NO_UNIT)
        return Ports((*pose, with_units(Port("u", size), of)), (with_units(Port("y", size), of),))

    def compute(self, context: EvaluationContext) -> Values:
        """Express u in the other frame by the pose (p, R), or by its inverse."""
        p, R, u = (context.inputs[name] for name in ("p", "R", "u"))
        if self.inverse:
            p, R = -(R.T @ p), R.T
        return {"y": transformed(self.quantity, p, R, u)}


@dataclass(frozen=True, kw_only=True)
class FrameTransform(Block):
    """A point, vector, velocity or wrench of one frame of a model in another of its frames; and their relative pose.

    Attributes:
        model: The model.
        source: Frame in whose axes, and about whose origin, the input is.
        target: Frame of the output.
        quantity: point, vector, velocity or wrench.
    """

    model: str
    source: str
    target: str = "world"
    quantity: str = "point"

    def __post_init__(self) -> None:
        """A known quantity."""
        choice(self.name, "quantity", self.quantity, QUANTITIES)

    def ports(self, environment: Environment) -> Ports:
        """Inputs q (nq), u; outputs y, and the source in the target: p (3), R (3, 3)."""
        for frame in (self.source, self.target):
            environment.frame(self.model, frame)
        record, size = environment.model(self.model), _size(self.quantity)
        of = _units(environment, self.quantity)
        inputs = (motion_port("q", record, "q"), with_units(Port("u", size, "", 0.0), of))
        return Ports(inputs, (with_units(Port("y", size), of), Port("p", (3,), "m"), Port("R", (3, 3), NO_UNIT)))

    def compute(self, context: EvaluationContext) -> Values:
        """Express u in the target frame, by both frames' poses in the world; also outputs the transform (p, R)."""
        source, target = (
            context.call(self.model, "frame_pose", frame, q=context.inputs["q"], t=context.t)
            for frame in (self.source, self.target)
        )
        R = target["R"].T @ source["R"]
        p = target["R"].T @ (source["p"] - target["p"])
        return {"y": transformed(self.quantity, p, R, context.inputs["u"]), "p": p, "R": R}


def _axis_angle(u: Tensor) -> Tensor:
    return matrix_of_vector(u[:3] * (u[3] / length(u[:3])))


def _as_axis_angle(R: Tensor) -> Tensor:
    w = vector_of_matrix(R)
    angle = length(w)
    # No rotation is one of no angle about x.
    none = 1.0 - (angle - 1e-100).apply("step")
    axis = w / angle * (1.0 - none)
    return joined([axis[0] + none, axis[1], axis[2], angle * (1.0 - none)])


_Form = tuple[Shape, Callable[[Tensor], Tensor], Callable[[Tensor], Tensor]]
# Form -> shape, to a matrix, from a matrix.
FORMS: dict[str, _Form] = {
    "matrix": ((3, 3), lambda R: R, lambda R: R),
    "quaternion": ((4,), matrix_of_quaternion, quaternion_of_matrix),
    "rotation_vector": ((3,), matrix_of_vector, vector_of_matrix),
    "axis_angle": ((4,), _axis_angle, _as_axis_angle),
}


def _euler_form(sequence: str) -> _Form:
    return (3,), lambda x: matrix_of_euler(x, sequence), lambda R: euler_of_matrix(R, sequence)


FORMS |= {f"euler_{sequence}": _euler_form(sequence) for sequence in EULER}


def _form_units(form: str) -> tuple[str, ...]:
    """Units of the numbers of an orientation."""
    if form in ("matrix", "quaternion"):
        return (NO_UNIT,)
    return (*(NO_UNIT,) * 3, "rad") if form == "axis_angle" else ("rad",)


@dataclass(frozen=True, kw_only=True)
class Orientation(Block):
    """An orientation in another form.

    Forms: matrix (3, 3); quaternion (4) x y z w, taken with w >= 0; rotation_vector (3), of at most pi; axis_angle (4),
    axis first; euler_zyx (3) and so on, R = Rz(x1) Ry(x2) Rx(x3), all twelve sequences [rad].

    Attributes:
        source: Form of the input.
        target: Form of the output.
    """

    source: str = "quaternion"
    target: str = "matrix"

    def __post_init__(self) -> None:
        """Refuse unknown forms."""
        choice(self.name, "source", self.source, FORMS)
        choice(self.name, "target", self.target, FORMS)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        source, target = (Port(name, FORMS[form][0]) for name, form in (("u", self.source), ("y", self.target)))
        return Ports((with_units(source, _form_units(self.source)),), (with_units(target, _form_units(self.target)),))

    def compute(self, context: EvaluationContext) -> Values:
        """Convert the orientation from the source form to the target form, by way of the rotation matrix."""
        return {"y": FORMS[self.target][2](FORMS[self.source][1](context.inputs["u"]))}


@dataclass(frozen=True, kw_only=True)
class OrientationError(Block):
    """The rotation vector from an actual orientation to the desired one, of at most pi [rad].

    Attributes:
        kind: Form of both inputs, as in `Orientation`.
        axes: "world", or "body", those of the actual orientation.
    """

    kind: str = "matrix"
    axes: str = "world"

    def __post_init__(self) -> None:
        """A known form, and axes."""
        choice(self.name, "kind", self.kind, FORMS)
        choice(self.name, "axes", self.axes, ("world", "body"))

    def ports(self, environment: Environment) -> Ports:
        """Inputs desired and actual; output error (3)."""
        shape = FORMS[self.kind][0]
        inputs = (with_units(Port(name, shape), _form_units(self.kind)) for name in ("desired", "actual"))
        return Ports(tuple(inputs), (Port("error", (3,), "rad"),))

    def compute(self, context: EvaluationContext) -> Values:
        """The logarithm of R_d R^T."""
        desired, actual = (FORMS[self.kind][1](context.inputs[name]) for name in ("desired", "actual"))
        error = error_vector(desired, actual)
        return {"error": error if self.axes == "world" else actual.T @ error}
