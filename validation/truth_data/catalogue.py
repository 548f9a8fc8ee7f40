"""The models and the functions of the data."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..engines.interface import Joint, Link, Tree, Vector, rows
from ..engines.models.kinds import link, placed

# Functions of `validation.engines.functions.FUNCTIONS` that have their values in the data.
FUNCTIONS = (
    "mass_matrix",
    "mass_matrix_inverse",
    "bias",
    "gravity",
    "inverse_dynamics",
    "joint_wrenches",
    "forward_dynamics",
    "kinetic_energy",
    "potential_energy",
    "link_poses",
    "link_velocities",
    "link_accelerations",
    "link_jacobians",
    "link_jacobian_rates",
    "centroidal_matrix",
    "centroidal_momentum_rate",
    "inverse_dynamics_dq",
    "inverse_dynamics_dv",
    "forward_dynamics_dq",
    "forward_dynamics_dv",
    "torque_regressor",
)


@dataclass(frozen=True)
class Model:
    """One model of the data.

    Attributes:
        tree: The tree.
        why: Reason why it is there.
    """

    tree: Tree
    why: str

    @property
    def name(self) -> str:
        """Name in the files."""
        return self.tree.name


_OBLIQUE: Vector = (2 / 3, -1 / 3, 2 / 3)
_X: Vector = (1.0, 0.0, 0.0)
_Y: Vector = (0.0, 1.0, 0.0)
_Z: Vector = (0.0, 0.0, 1.0)


def _tree(name: str, seed: int, *joints: tuple[int, Joint], sizes: tuple[float, ...] = ()) -> Tree:
    """Links on oblique joints; each joint with the index of the link that carries it."""
    draw = np.random.default_rng(seed)
    links: list[Link] = []
    for k, (parent, joint) in enumerate(joints):
        made = link(draw, f"link{k}", parent, joint if joint.kind == "free" else placed(draw, joint))
        scale = sizes[k] if sizes else 1.0
        inertia = rows(scale * np.array(made.inertia))
        links.append(replace(made, mass=scale * made.mass, inertia=inertia))
    return Tree(name, tuple(links))


def _hinge(axis: Vector) -> Joint:
    return Joint("revolute", axis=axis)


def _slide(axis: Vector) -> Joint:
    return Joint("prismatic", axis=axis)


def models() -> tuple[Model, ...]:
    """All models: few bodies, nothing aligned that need not be; depth first, as readers of files number joints."""
    serial = [(k - 1, _hinge((_X, _Y, _Z)[k % 3])) for k in range(6)]
    return (
        Model(_tree("two_hinges", 1, (-1, _hinge(_Y)), (0, _hinge(_Y))), "the smallest tree with everything in it"),
        Model(_tree("oblique_hinges", 2, *((k - 1, _hinge(_OBLIQUE)) for k in range(3))), "axes along no axis"),
        Model(
            _tree("slides_and_hinges", 3, (-1, _slide(_X)), (0, _hinge(_Z)), (1, _slide(_OBLIQUE)), (2, _hinge(_X))),
            "prismatic joints between rotating links",
        ),
        Model(_tree("arm", 4, *serial), "a serial arm of six joints"),
        Model(
            _tree(
                "tree", 5, (-1, _hinge(_Z)), (0, _hinge(_X)), (1, _hinge(_Y)), (0, _slide(_Y)), (3, _hinge(_OBLIQUE))
            ),
            "two branches",
        ),
        Model(
            _tree("fixed_amid", 6, (-1, _hinge(_Y)), (0, Joint("fixed")), (1, _hinge(_X)), (2, Joint("fixed"))),
            "links fixed to others, in the middle and at the end",
        ),
        Model(
            _tree("heavy_on_light", 7, *((k - 1, _hinge(_OBLIQUE)) for k in range(3)), sizes=(1e-4, 1.0, 1e3)),
            "masses seven decades apart",
        ),
        Model(
            _tree("floating", 8, (-1, Joint("free")), (0, _hinge(_Y)), (1, _slide(_Z)), (0, _hinge(_OBLIQUE))),
            "a floating base with two limbs",
        ),
        Model(_tree("balls", 9, (-1, Joint("ball")), (0, Joint("ball"))), "ball joints in series"),
        Model(
            _tree(
                "screws",
                10,
                (-1, Joint("helical", axis=_Z, pitch=0.25)),
                (0, Joint("helical", axis=_OBLIQUE, pitch=-0.5)),
            ),
            "helical joints",
        ),
    )
