"""SKEL, DART's own format: bodies stand in the world, joints in their child (dart/utils/SkelParser).

Placements turn about one axis, so that no order of angles has a part in them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from ...interface import Joint, Link
from . import readers
from .readers import LIMITED, LOSSES, OBLONG, PRINCIPAL, PRODUCTS, Reading, about, diagonal

_of = partial(readers.reading, "skel")
_PLAIN = (0.2, 0.3, 0.4, 0.0, 0.0, 0.0)
_FIRST = Link("a", -1, (Joint("revolute", p=(0.1, 0.2, 0.3)),), 2.0, (0.1, -0.2, 0.3), PRINCIPAL)
_NEXT = Link("b", 0, (Joint("revolute", p=(0.0, 0.0, 0.5), axis=(0.0, 1.0, 0.0)),), 1.0, (0.0, 0.1, 0.2), PRINCIPAL)
_Z, _Y = "<axis><xyz>0 0 1</xyz>{}</axis>", "<axis><xyz>0 1 0</xyz>{}</axis>"


def _body(name: str, at: str, mass: float, offset: str, moments: tuple[float, ...] = _PLAIN) -> str:
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    stated = "".join(f"<{one}>{value!r}</{one}>" for one, value in zip(names, moments, strict=True))
    inertia = f"<mass>{mass!r}</mass><offset>{offset}</offset><moment_of_inertia>{stated}</moment_of_inertia>"
    return f'<body name="{name}"><transformation>{at}</transformation><inertia>{inertia}</inertia></body>'


_A = partial(_body, "a", mass=2.0, offset="0.1 -0.2 0.3")
_B = partial(_body, "b", mass=1.0, offset="0 0.1 0.2")


def _joint(kind: str, name: str, parent: str, more: str) -> str:
    ends = f"<parent>{parent}</parent><child>{name}</child>"
    return f'<joint type="{kind}" name="joint_{name}">{ends}{more}</joint>'


def _file(first: str = "", second: str = "", a: str = "", b: str = "") -> str:
    """Two bodies on hinges, but for what is stated otherwise."""
    parts = (
        a or _A(at="0.1 0.2 0.3 0 0 0"),
        b or _B(at="0.1 0.2 0.8 0 0 0"),
        first or _joint("revolute", "a", "world", _Z.format("")),
        second or _joint("revolute", "b", "a", _Y.format("")),
    )
    physics = "<physics><time_step>0.001</time_step><gravity>0 0 -9.81</gravity></physics>"
    return f'<skel version="1.0"><world name="w">{physics}<skeleton name="s">{"".join(parts)}</skeleton></world></skel>'


def _first(kind: str, more: str = "", **changes: object) -> tuple[str, Link]:
    """The first joint's element, and the link on it."""
    joint = replace(_FIRST.joints[0], kind=kind, **changes)  # type: ignore[arg-type]
    names = {"helical": "screw", "translation": "translational"}
    return _joint(names.get(kind, kind), "a", "world", more), replace(_FIRST, joints=(joint,))


def _stated() -> Iterator[tuple[str, Reading]]:
    yield _of("plain", _file(), _FIRST, _NEXT)
    turned = Joint("revolute", R=about((1.0, 0.0, 0.0), 0.5), p=(0.1, 0.2, 0.3))
    beside = _B(at="0.1 0.2 0.3 0.5 0 0")
    on_it = replace(_NEXT, joints=(replace(_NEXT.joints[0], p=(0.0, 0.0, 0.0)),))
    yield _of("body turned", _file(a=_A(at="0.1 0.2 0.3 0.5 0 0"), b=beside), replace(_FIRST, joints=(turned,)), on_it)
    oblong = _A(at="0.1 0.2 0.3 0 0 0", moments=PRODUCTS)
    yield _of("products of inertia", _file(a=oblong), replace(_FIRST, inertia=OBLONG), _NEXT)
    equal = _A(at="0.1 0.2 0.3 0 0 0", moments=(0.3, 0.3, 0.3, 0.0, 0.0, 0.0))
    yield _of("equal moments", _file(a=equal), replace(_FIRST, inertia=diagonal(0.3, 0.3, 0.3)), _NEXT)
    placed = _joint("revolute", "b", "a", f"<transformation>0.25 0 0 0 0 0.5</transformation>{_Y.format('')}")
    turn = about((0.0, 0.0, 1.0), 0.5)
    aside = Joint("revolute", R=turn, p=(0.25, 0.0, 0.5), axis=(0.0, 1.0, 0.0))
    back = about((0.0, 0.0, 1.0), -0.5)
    # The child's origin is -R^T p from the joint's frame.
    origin = tuple(-sum(turn[i][k] * (0.25, 0.0, 0.0)[i] for i in range(3)) for k in range(3))
    behind = replace(_NEXT, joints=(aside, Joint("fixed", R=back, p=origin)))  # type: ignore[arg-type]
    yield _of("joint placed in its child", _file(second=placed), _FIRST, behind)


def _kinds() -> Iterator[tuple[str, Reading]]:
    oblique = "<axis><xyz>0.6 0 0.8</xyz></axis>"
    for name, more, changes in (
        ("revolute", oblique, {"axis": (0.6, 0.0, 0.8)}),
        ("prismatic", oblique, {"axis": (0.6, 0.0, 0.8)}),
        (
            "universal",
            "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>",
            {"axis": (0.0, 0.0, 1.0), "second": (0.0, 1.0, 0.0)},
        ),
        ("ball", "", {}),
        ("translation", "", {}),
        ("free", "", {}),
    ):
        element, link = _first(name, more, **changes)
        yield _of(f"{name} joint", _file(element), link, _NEXT)
    held = replace(_FIRST, joints=(replace(_FIRST.joints[0], kind="fixed"),))
    yield _of("weld joint", _file(_joint("weld", "a", "world", "")), held, _NEXT)


def _losses() -> Iterator[tuple[str, Reading]]:
    lost = "<dynamics><damping>0.75</damping><friction>0.25</friction></dynamics>"
    element, link = _first("revolute", _Z.format(lost), damping=0.75, friction=0.25)
    yield _of("losses of a hinge", _file(element), link, _NEXT, asked=LOSSES)
    sprung = "<spring_stiffness>4</spring_stiffness><spring_rest_position>0.25</spring_rest_position>"
    element, link = _first("revolute", _Z.format(f"<dynamics>{sprung}</dynamics>"), stiffness=4.0, rest=0.25)
    yield _of("spring of a hinge", _file(element), link, _NEXT, asked=LOSSES)
    limit = "<limit><lower>-0.5</lower><upper>1.25</upper></limit>"
    element, link = _first("revolute", _Z.format(limit), limits=(-0.5, 1.25))
    both = _joint("revolute", "b", "a", _Y.format(limit))
    yield _of(
        "limits of hinges",
        _file(element, both),
        link,
        replace(_NEXT, joints=(replace(_NEXT.joints[0], limits=(-0.5, 1.25)),)),
        asked=LIMITED,
    )


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_stated(), *_kinds(), *_losses()])
