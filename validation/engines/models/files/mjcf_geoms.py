"""MJCF: inertia that is inferred from geoms and meshes, of their masses, densities, shapes and defaults."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import ORIGIN, Array, Link, rows, vector
from . import readers
from .mjcf import FIRST, JOINT_B, RADIAN, dense, file, solid_of
from .readers import NEXT, Reading, diagonal

_of = partial(readers.reading, "mjcf")


def _of_simplices(parts: Sequence[tuple[float, Array]]) -> Link:
    """The second link, of triangles or tetrahedra: the mass of each, and its corners (k, 3).

    Of a uniform simplex with k corners x and their sum s, the mean of r r^T is (sum of x x^T + s s^T) / (k (k + 1)).
    """
    mass = math.fsum(one for one, _ in parts)
    com = sum(one * x.mean(axis=0) for one, x in parts) / mass
    second = np.zeros((3, 3))
    for one, corners in parts:
        x = corners - com
        s, k = x.sum(axis=0), len(x)
        second += one * (x.T @ x + np.outer(s, s)) / (k * (k + 1))
    return replace(NEXT, mass=mass, com=vector(com), inertia=rows(np.trace(second) * np.eye(3) - second))


def _meshes() -> Iterator[tuple[str, Reading]]:
    """Inertia of a mesh, full or a shell, by mass and by density, of its own and by default.

    It is a box between the origin and a corner of three, so that MuJoCo need not search for principal axes.
    """
    corners = np.array([[x, y, z] for z in (0.0, 0.75) for y in (0.0, 0.25) for x in (0.0, 0.5)])
    squares = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    faces = [three for a, b, c, d in squares for three in ((a, b, c), (a, c, d))]
    sides = [corners[list(three)] for three in faces]
    areas = [float(np.linalg.norm(np.cross(x[1] - x[0], x[2] - x[0]))) / 2.0 for x in sides]
    pieces = [np.vstack([corners.mean(axis=0), x]) for x in sides]
    volume, parts = 0.5 * 0.25 * 0.75, [abs(float(np.linalg.det(x[1:] - x[0]))) / 6.0 for x in pieces]
    vertices = "  ".join(" ".join(map(repr, corner)) for corner in corners.tolist())
    data = f'vertex="{vertices}" face="{"  ".join(" ".join(map(str, three)) for three in faces)}"'

    def uniform(mass: float, shares: Sequence[float], shapes: Sequence[Array]) -> Link:
        return _of_simplices([(mass * share / math.fsum(shares), x) for share, x in zip(shares, shapes, strict=True)])

    def second(name: str, mesh: str, geom: str, link: Link, head: str = RADIAN) -> tuple[str, Reading]:
        head += f'<asset><mesh name="t" {data} {mesh}/></asset>'
        text = file(b=f'{JOINT_B}<geom type="mesh" mesh="t" {geom}/>', head=head)
        return _of(f"mesh {name}", text, FIRST, link)

    full, thin = uniform(3.0, parts, pieces), uniform(6.0 * math.fsum(areas), areas, sides)
    yield second("of a mass", "", 'mass="3"', full)
    yield second("of a mass, shown only", "", 'mass="3" contype="0" conaffinity="0" group="2"', full)
    yield second("of a density", "", 'density="700"', uniform(700.0 * volume, parts, pieces))
    yield second("that is a shell, of a density", 'inertia="shell"', 'density="6"', thin)
    yield second("that is a shell, of a mass", 'inertia="shell"', 'mass="3"', uniform(3.0, areas, sides))
    scaled = uniform(3.0, parts, [x * np.array([2.0, 1.0, 0.5]) for x in pieces])
    yield second("that is scaled", 'scale="2 1 0.5"', 'mass="3"', scaled)
    shells = f'{RADIAN}<default><default class="k"><mesh inertia="shell"/></default></default>'
    yield second("of a class of shells", 'class="k"', 'density="6"', thin, shells)
    scales = f'{RADIAN}<default><mesh scale="2 1 0.5"/></default>'
    yield second("scaled by default", "", 'mass="3"', scaled, scales)
    # A class is that of the mesh: of the geom's own class no mesh takes its scale.
    small, large = ((size**3 * 700.0 * volume, [x * size for x in pieces]) for size in (0.5, 2.0))
    sizes = "".join(
        f'<default class="{name}"><mesh scale="{x} {x} {x}"/></default>' for name, x in (("k", 0.5), ("l", 2))
    )
    classes = f"{RADIAN}<default>{sizes}</default>"
    yield second("scaled by its class", 'class="k"', 'density="700"', uniform(small[0], parts, small[1]), classes)
    yield second(
        "scaled by its class, not the geom's",
        'class="l"',
        'class="k" density="700"',
        uniform(large[0], parts, large[1]),
        classes,
    )
    yield second(
        "of no scale, of a geom whose class has one",
        "",
        'class="k" density="700"',
        uniform(700.0 * volume, parts, pieces),
        classes,
    )


def _fitted() -> Iterator[tuple[str, Reading]]:
    """Boxes that are fitted to a mesh: around its vertices, or of its moments of inertia.

    It is a pyramid along x, of which the principal axes are known, and the mass centre is not amid the vertices. Its
    own frame takes y, z, x for x, y, z by MuJoCo's order of moments: a rotation whose quaternion floats state exactly.
    """
    h, b, c = 2.0, 0.25, 0.5
    corners = [(0.0, -b, -c), (0.0, b, -c), (0.0, b, c), (0.0, -b, c), (h, 0.0, 0.0)]
    faces = ((0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))
    data = f'vertex="{"  ".join(" ".join(map(repr, one)) for one in corners)}"'
    data += f' face="{"  ".join(" ".join(map(str, three)) for three in faces)}"'
    # For unit mass, about the mass centre, at h / 4: 3 h^2 / 80, b^2 / 5, c^2 / 5 along x, y, z.
    spread = np.array([3.0 * h * h / 80.0, b * b / 5.0, c * c / 5.0])

    def second(name: str, half: Array, at: float, head: str) -> tuple[str, Reading]:
        text = f'{head}<asset><mesh name="t" {data}/></asset>'
        link = dense(solid_of("box", *map(float, half)), com=(at, 0.0, 0.0))
        return _of(f"box fitted {name}", file(b=f'{JOINT_B}<geom type="box" mesh="t"/>', head=text), FIRST, link)

    fitted = RADIAN.replace("/>", ' fitaabb="true"/>')
    yield second("around a mesh", np.array([h / 2.0, b, c]), h / 2.0, fitted)
    yield second("to a mesh's moments", np.sqrt(3.0 * spread), h / 4.0, RADIAN)


def _geoms() -> Iterator[tuple[str, Reading]]:
    """Inertia that is inferred from geoms."""

    def second(name: str, geoms: str, link: Link, head: str = RADIAN) -> tuple[str, Reading]:
        return _of(name, file(b=JOINT_B + geoms, head=head), FIRST, link)

    ball = dense(solid_of("ellipsoid", 0.1, 0.1, 0.1))
    one, two = (f'<geom size="0.1" pos="0 0 {at}" mass="{mass}"/>' for at, mass in ((0.3, 1), (-0.3, 2)))
    moment = 3.0 * 0.004
    across = moment + 1.0 * 0.4**2 + 2.0 * 0.2**2
    pair = replace(NEXT, mass=3.0, com=(0.0, 0.0, -0.1), inertia=diagonal(across, across, moment))
    grouped = '<compiler angle="radian" inertiagrouprange="0 2"/>'
    shown = '<geom size="0.3" pos="1 1 1" group="3"/>'
    yield second("geoms of groups that don't count", f'<geom size="0.1"/>{shown}', ball, grouped)
    yield second("geoms of groups that count", f'<geom size="0.1" group="2"/>{shown}', ball, grouped)
    shown_only = 'contype="0" conaffinity="0" group="2"'
    visual = two.replace("/>", f" {shown_only}/>")
    yield second("mass of a visual geom beside a solid one", one + visual, pair)
    alone = replace(NEXT, mass=2.0, com=ORIGIN, inertia=diagonal(0.008, 0.008, 0.008))
    yield second("mass of a visual geom", f'<geom size="0.1" mass="2" {shown_only}/>', alone)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_geoms(), *_meshes(), *_fitted()])
