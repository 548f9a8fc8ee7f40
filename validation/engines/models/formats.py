"""One tree in each format, so that all readers must agree; and what SDF states in more than one way."""

from __future__ import annotations

import numpy as np

from ..interface import Joint, Link, Tree, Unsupported
from ..plugins import mujoco
from ..plugins.writing import sdf, urdf
from .hostile import trees as hostile_trees
from .kinds import OBLIQUE, link, placed
from .readers import Reading, rpy_rotation

_WIDE = '<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>'
_LIMIT = "<limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit>"
_PRINCIPAL = ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))
_TURNED = rpy_rotation(0.3, -0.4, 0.5)
_INERTIAL = (
    "<inertial><pose>0.1 -0.2 0.3 {}</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz>"
    "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
)


def _chain() -> Tree:
    draw = np.random.default_rng(12)
    kinds = ("revolute", "prismatic", "revolute", "prismatic")
    return Tree(
        "slides and hinges",
        tuple(link(draw, "abcd"[k], k - 1, placed(draw, Joint(kind, axis=OBLIQUE))) for k, kind in enumerate(kinds)),
    )


def texts(tree: Tree) -> dict[str, str]:
    """The tree in each format that states it."""
    described, document, model = urdf.describe(tree), mujoco.document(tree), sdf.describe(tree)
    made: dict[str, str] = {}
    if not isinstance(described, Unsupported):
        # Not all readers keep a hinge without limits by its angle.
        made["urdf"] = described.text.replace('type="continuous">', f'type="revolute">{_WIDE}')
    if not isinstance(document, Unsupported):
        made["mjcf"] = document[0]
    if not isinstance(model, Unsupported):
        made["sdf"] = model
    return made


def _one_link(name: str, head: str, inertial: str, axis: str, tree_link: Link, end: str = "") -> tuple[str, Reading]:
    """SDF of a body on a hinge in the world."""
    parts = f"{end}<parent>world</parent><child>a</child><axis>{axis}{_LIMIT}</axis>"
    joint = f'<joint name="ja" type="revolute">{parts}</joint>'
    # What needs frames' names needs a version that has them; old parsers refuse those.
    version = "1.9" if "relative_to" in head or "expressed_in" in axis else "1.6"
    text = f'<sdf version="{version}"><model name="m"><link name="a">{head}{inertial}</link>{joint}</model></sdf>'
    return name, Reading("sdf", text, Tree(name, (tree_link,)))


def _variants() -> dict[str, Reading]:
    hinge = Joint("revolute", R=_TURNED, p=(0.1, 0.2, 0.3), axis=(0.6, 0.0, 0.8))
    body = Link("a", -1, (hinge,), 2.0, (0.1, -0.2, 0.3), _PRINCIPAL)
    at = "0.1 0.2 0.3 0.3 -0.4 0.5"
    plain, axis = _INERTIAL.format("0 0 0"), "<xyz>0.6 0 0.8</xyz>"
    R = np.array(rpy_rotation(0.5, 0.6, 0.7))
    inertia = R @ np.array(_PRINCIPAL) @ R.T
    turned = tuple(tuple(row) for row in ((inertia + inertia.T) / 2).tolist())
    along = tuple((np.array(_TURNED).T @ np.array(hinge.axis)).tolist())
    own = f"<pose>{at}</pose>"
    joint = Joint("revolute", R=_TURNED, p=hinge.p, axis=along)
    sideways = Link("a", -1, (joint,), 2.0, body.com, _PRINCIPAL)
    return dict(
        (
            _one_link("sdf: plain", own, plain, axis, body),
            _one_link(
                "sdf: inertial frame turned", own, _INERTIAL.format("0.5 0.6 0.7"), axis,
                Link("a", -1, (hinge,), 2.0, body.com, turned),  # type: ignore[arg-type]
            ),
            _one_link("sdf: axis of length 2", own, plain, "<xyz>1.2 0 1.6</xyz>", body),
            _one_link(
                "sdf: pose relative to its joint", '<pose relative_to="ja"/>', plain, axis, body,
                end=f'<pose relative_to="__model__">{at}</pose>',
            ),
            _one_link(
                "sdf: axis along the model's", own, plain, '<xyz expressed_in="__model__">0.6 0 0.8</xyz>', sideways
            ),
            _one_link(
                "sdf: axis along the parent model's", own, plain,
                f"{axis}<use_parent_model_frame>1</use_parent_model_frame>", sideways,
            ),
            _one_link(
                "sdf: anchor of a joint", own, plain, axis,
                Link(
                    "a", -1,
                    (
                        Joint("fixed", R=_TURNED, p=hinge.p),
                        Joint("revolute", p=(0.0, -0.1, 0.2), axis=hinge.axis),
                        Joint("fixed", p=(0.0, 0.1, -0.2)),
                    ),
                    2.0, body.com, _PRINCIPAL,
                ),
                end="<pose>0 -0.1 0.2 0 0 0</pose>",
            ),
        )
    )  # fmt: off


def formats() -> dict[str, Reading]:
    """All of them, by name."""
    hostile = hostile_trees()
    made = {}
    for tree in (hostile["six oblique hinges"], hostile["fixed links amid"], _chain()):
        for form, text in texts(tree).items():
            name = f"{form} of {tree.name}"
            made[name] = Reading(form, text, Tree(name, tree.links, tree.gravity))
    return made | _variants()
