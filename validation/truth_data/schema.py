"""JSON Schema of the data's files: models and values."""

from __future__ import annotations

from typing import Any


def _numbers(count: int | None = None) -> dict[str, Any]:
    bounds = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "items": {"type": "number"}, **bounds}


def _object(**properties: Any) -> dict[str, Any]:
    """An object with these entries; those that end with "_" may be absent."""
    required = [name for name in properties if not name.endswith("_")]
    named = {name.removesuffix("_"): value for name, value in properties.items()}
    return {"type": "object", "properties": named, "required": required, "additionalProperties": False}


_COUNT: dict[str, Any] = {"type": "integer", "minimum": 0}
_COUNTS: dict[str, Any] = {"type": "array", "items": _COUNT}
_TEXT: dict[str, Any] = {"type": "string"}
_MATRIX: dict[str, Any] = {"type": "array", "items": _numbers(3), "minItems": 3, "maxItems": 3}
_ROTATION = _MATRIX | {"description": "Rows; it means the nearest rotation, U V^T of U S V^T."}
_AXIS = _numbers(3) | {"description": "It means the vector of unit length along it."}
_JOINT = _object(
    kind={"enum": ["fixed", "revolute", "prismatic", "helical", "ball", "free"]},
    R=_ROTATION,
    p=_numbers(3),
    axis_=_AXIS,
    pitch_={"type": "number"},
    chart_=_TEXT,
    q_=_COUNTS,
    v_=_COUNTS,
)
_LINK = _object(
    name=_TEXT,
    parent={"type": "integer", "minimum": -1},
    mass={"type": "number"},
    com=_numbers(3),
    inertia=_MATRIX,
    joint=_JOINT,
)
_VALUE = _object(
    shape=_COUNTS,
    digits={"type": "array", "items": {"type": "string", "pattern": r"^-?[0-9]\.[0-9]{29}e[+-][0-9]+$"}},
)
_STATE = _object(
    q=_numbers(),
    v=_numbers(),
    a=_numbers(),
    tau=_numbers(),
    values={"type": "object", "additionalProperties": _VALUE},
)

SCHEMA: dict[str, Any] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "symofros-truth: models/NAME.json and values/NAME.json",
    "anyOf": [{"$ref": "#/$defs/model"}, {"$ref": "#/$defs/values"}],
    "$defs": {
        "model": _object(
            name=_TEXT, gravity=_numbers(3), nq=_COUNT, nv=_COUNT, links={"type": "array", "items": _LINK}
        ),
        "values": _object(model=_TEXT, states={"type": "array", "items": _STATE}),
    },
}
