"""USD: masses that colliders state themselves, of bodies with and without MassAPI; scales of the prims above."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from . import readers
from .readers import NEXT, Reading, hung
from .usd import file, shape

_of = partial(readers.reading, "usd")
_API = ', "PhysicsMassAPI"'
_SIDE, _WATER = 0.5, 1000.0
# Where the body of `usd_files.file` has its first collider.
_AT = (0.0, 0.125, 0.25)


def _cube(mass: float) -> tuple[float, ...]:
    """Moments of a cube about its centre."""
    return (mass * _SIDE**2 / 6.0,) * 3


def _colliders() -> Iterator[tuple[str, Reading]]:
    """One collider, or two, enabled or not, by their masses and densities."""
    body = replace(hung(NEXT), parent=-1, com=_AT)
    size, moved = f"double size = {_SIDE}", "(0, 0.125, 1.25)"
    heavy, dense = (shape("Cube", size, f"float physics:{one}", _API) for one in ("mass = 3", "density = 250"))
    off = shape("Cube", size, "bool physics:collisionEnabled = 0\n            float physics:mass = 4", _API)
    second = (
        shape("Cube", size, "float physics:mass = 1", _API).replace('"s"', '"t"').replace("(0, 0.125, 0.25)", moved)
    )
    plain = shape("Cube", size)
    other = off.replace('"s"', '"t"')
    water = _WATER * _SIDE**3
    light = (water / 4.0, _AT, _cube(water / 4.0))
    # Of 3 kg and 1 kg, 1 m apart along z: the centre is a quarter of the way, 3/4 kg m^2 are added across.
    x, _, z = _cube(4.0)
    pair = (4.0, (0.0, 0.125, 0.5), (x + 0.75, x + 0.75, z))
    cases = {
        "of its own mass": (heavy, (3.0, _AT, _cube(3.0))),
        "of its own density": (dense, light),
        "of a mass before one that is disabled": (f"{heavy}\n        {other}", (3.0, _AT, _cube(3.0))),
        "of a mass after one that is disabled": (f"{other}\n        {heavy}", (3.0, _AT, _cube(3.0))),
        "of a density before one that is disabled": (
            f"{dense}\n        {other}",
            (water / 4.0, _AT, _cube(water / 4.0)),
        ),
        "by default before one that is disabled": (f"{plain}\n        {other}", (water, _AT, _cube(water))),
        "of a mass beside another": (f"{heavy}\n        {second}", pair),
    }
    for name, (inside, (mass, com, moments)) in cases.items():
        link = replace(body, mass=mass, com=com, inertia=readers.diagonal(*moments))
        text = file(inertial=inside)
        yield _of(f"collider {name}", text, link)
        bare = text.replace(', "PhysicsMassAPI"]) {\n        double3', "]) {\n        double3", 1)
        yield _of(f"collider {name}, body without MassAPI", bare, link)


def _scaled() -> Iterator[tuple[str, Reading]]:
    """Prims above a body that are scaled: places and the stated mass centre are in their units."""
    link = replace(hung(NEXT), parent=-1, com=_AT, inertia=readers.diagonal(0.25, 0.375, 0.5))
    plain = file()
    above = 'def Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {'
    for name, scale, at, com in (
        ("scale of the prim above", "(2, 2, 2)", "(0, 0, 0.25)", "(0, 0.0625, 0.125)"),
        ("scale of the prim above, by axes", "(4, 0.5, 2)", "(0, 0, 0.25)", "(0, 0.25, 0.125)"),
    ):
        turned = f'{above}\n    double3 xformOp:scale = {scale}\n    uniform token[] xformOpOrder = ["xformOp:scale"]'
        text = plain.replace(above, turned).replace("xformOp:translate = (0, 0, 0.5)", f"xformOp:translate = {at}")
        text = text.replace("physics:centerOfMass = (0, 0.125, 0.25)", f"physics:centerOfMass = {com}")
        yield _of(f"mass centre below {name}", text, link)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_colliders(), *_scaled()])
