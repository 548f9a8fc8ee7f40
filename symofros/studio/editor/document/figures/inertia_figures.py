"""Mass, mass centre and moments of inertia of a rigid body as one types it, for the body's window."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import ValidationError

from symofros.description import RigidBody, System
from symofros.description.yaml import InertiaEntry, SolidEntry
from symofros.errors import DescriptionError
from symofros.mechanics.topology import Numbers, moments_about_center
from symofros.studio.editor.editing.data_edits import EditError

Json = dict[str, Any]

_ENTRIES: dict[str, type[InertiaEntry] | type[SolidEntry]] = {"inertia": InertiaEntry, "solid": SolidEntry}


def inertia_figures(stated: Json, known: Mapping[str, float]) -> Json:
    """Figures of a rigid body at the parameters' defaults.

    Returns:
        `mass` [kg], `center_of_mass` in the body frame (3) [m]; `moments` Ixx, Iyy, Izz and `products` Ixy, Ixz, Iyz
        about the mass centre, along the axes of the body frame [kg m^2].

    Raises:
        EditError: It is neither, not complete, or has no numbers.
    """
    try:
        key = next(key for key in _ENTRIES if key in stated)
        inertia = _ENTRIES[key].model_validate(stated[key]).build()
        body = RigidBody("body", None, inertia)
        numbers = Numbers(System("figures", (body,)), known)
        turn, own = numbers.rotation(inertia.rotation), moments_about_center(body, numbers)
        mass, center = numbers.value(inertia.mass), numbers.values(inertia.center_of_mass)
    except (StopIteration, ValidationError, DescriptionError, KeyError, ArithmeticError) as error:
        raise _incomplete(str(error)[:100] or type(error).__name__) from None
    if not np.all(np.isfinite([mass, *center, *own.flat, *turn.flat])):
        raise _incomplete("a value that is no finite number")
    matrix = turn @ own @ turn.T
    return {
        "mass": mass,
        "center_of_mass": center.tolist(),
        "moments": matrix.diagonal().tolist(),
        "products": matrix[np.triu_indices(3, 1)].tolist(),
    }


def _incomplete(found: str) -> Exception:
    rule = "figures are of a body with numbers for its mass and sizes"
    return EditError("the inertia is not complete", found, rule, "fill in what is marked")
