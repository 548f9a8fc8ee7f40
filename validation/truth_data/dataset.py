"""The data: values of each function of each model at some states, thirty digits each, and how they are written.

manifest.json      version, conventions, functions, models, size and digest of each file
schema.json        JSON Schema of the other JSON files
models/NAME.json   the model as numbers; .urdf, .xml (MJCF), .yaml where the format has its joints
values/NAME.json   states, and the values as texts of thirty digits, row by row
values.parquet     the same in one table, also as doubles
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf
from symofros.tools import write_atomically

from ..engines.functions import FUNCTIONS as ALL
from ..engines.proving.pieces import OURS, Layout
from ..engines.truth.arithmetic import many_digits
from ..engines.truth.charts import CHARTS
from ..engines.truth.dynamics import Point, Truth, random_state
from .catalogue import FUNCTIONS, Model
from .descriptions import files, numbers


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


VERSION = "1"
STATES = 3
DIGITS = 30
NEGLIGIBLE = Decimal("1e-33")

CONVENTIONS = (
    "SI units and radians. The world's z axis points up unless the model's gravity says otherwise.",
    "A link's frame stands where its joint leaves it; the joint is placed in the parent link's frame by p and R, whose "
    "columns are the placed axes. The numbers of models/NAME.json are exact; other formats repeat them to rounding.",
    "Doubles state no exact rotation and no exact direction. An R means the nearest rotation, U V^T of its singular "
    "value decomposition U S V^T; an axis means the vector of unit length along it; a quaternion among q likewise. All "
    "other numbers are taken as they are. Worked out so in 60 digits, the values agree to all that are written; with "
    "R, axes and quaternions as they are, to 1e-16 at best.",
    "q and v hold the joints in the order of the links; `chart` says what a joint's entries are. Quaternions are "
    "(x, y, z, w). Speeds of ball and free joints lie along the axes after the joint, linear before angular.",
    "Spatial quantities of links stack linear and angular parts, of the link's origin, along the world's axes.",
    "The digits are right relative to the largest entry of a value; what is below 1e-33 of it is zero.",
    "Derivatives by q are along the speeds: column k is the rate of change as q moves with speed k alone.",
    "M a + h = tau + nothing else: no friction, no limits, no armature.",
)


def values_of(model: Model, count: int = STATES) -> dict[str, Any]:
    """States of a model and the values there, as values/NAME.json holds them."""
    made = Layout.ours(model.tree)
    states = []
    with many_digits():
        truth = Truth(model.tree, made)
        for seed in range(count):
            state = random_state(model.tree, made, seed)
            point = Point.of(state)
            stated: dict[str, Any] = {name: getattr(state, name).tolist() for name in ("q", "v", "a", "tau")}
            stated["values"] = {name: _texts(ALL[name].truth(truth, point)) for name in FUNCTIONS}
            states.append(stated)
    return {"model": model.name, "states": states}


def _texts(value: Any) -> dict[str, Any]:
    array = np.asarray(value, dtype=object)
    numbers = [Decimal(x) for x in array.ravel()]
    # What cancels leaves rounding of the last of 130 digits, or of differences.
    least = max((abs(x) for x in numbers), default=Decimal(0)) * NEGLIGIBLE
    return {"shape": list(array.shape), "digits": [_text(x if abs(x) > least else Decimal(0)) for x in numbers]}


def _text(value: Decimal) -> str:
    return f"{value:.{DIGITS - 1}e}"


def write(folder: Path, models: Sequence[Model], done: Callable[[str], None] = lambda name: None) -> None:
    """Write the data of some models; files of other models stay.

    Raises:
        OSError: The folder can't be written to.
    """
    written: dict[str, str] = {"schema.json": _json(SCHEMA)}
    everything = []
    for model in models:
        written[f"models/{model.name}.json"] = _json(numbers(model.tree))
        written |= {f"models/{model.name}.{suffix}": text for suffix, text in files(model.tree).items()}
        values = values_of(model)
        everything.append(values)
        written[f"values/{model.name}.json"] = _json(values)
        done(model.name)
    for name, text in written.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_atomically(folder / name, text)
    table = _parquet(everything)
    write_atomically(folder / "values.parquet", table)
    digests = {name: _digest(text.encode()) for name, text in written.items()} | {"values.parquet": _digest(table)}
    write_atomically(folder / "manifest.json", _json(_manifest(models, digests)))


def _manifest(models: Sequence[Model], digests: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": "symofros-truth",
        "version": VERSION,
        "digits": DIGITS,
        "made_by": f"symofros {sf.__version__}, python -m validation truth",
        "method": "Newton's and Euler's equations of each link projected by its Jacobian, in 130 decimal digits; "
        "derivatives by central differences of step 1e-18 (validation/engines/truth/dynamics.py)",
        "conventions": list(CONVENTIONS),
        "charts": {name: CHARTS[name].text for name in sorted(set(OURS.values()))},
        "functions": {name: ALL[name].text for name in FUNCTIONS},
        "models": {model.name: model.why for model in models},
        "files": digests,
    }


def _digest(content: bytes) -> dict[str, Any]:
    return {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _rows(everything: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for values in everything:
        for index, state in enumerate(values["states"]):
            inputs = {name: state[name] for name in ("q", "v", "a", "tau")}
            for function, value in state["values"].items():
                doubles = [float(text) for text in value["digits"]]
                row = {"model": values["model"], "state": index, **inputs, "function": function}
                yield row | {"shape": value["shape"], "digits": value["digits"], "value": doubles}


def _parquet(everything: Sequence[dict[str, Any]]) -> bytes:
    import pyarrow  # An extra: files of text are written without it.
    import pyarrow.parquet  # As above.

    numbers_of, text = pyarrow.list_(pyarrow.float64()), pyarrow.string()
    fields = [
        ("model", text),
        ("state", pyarrow.int32()),
        *((name, numbers_of) for name in ("q", "v", "a", "tau")),
        ("function", text),
        ("shape", pyarrow.list_(pyarrow.int32())),
        ("digits", pyarrow.list_(text)),
        ("value", numbers_of),
    ]
    table = pyarrow.Table.from_pylist(list(_rows(everything)), pyarrow.schema(fields))
    sink = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, sink, compression="zstd")
    content: bytes = sink.getvalue().to_pybytes()
    return content
