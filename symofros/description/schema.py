"""The native file's shape as pydantic models: the reader validates with them, the JSON Schema is made from them.

Each entry knows how to become its noun (`build`), so that a new field is added in one place. Rewrite the published
schema after a change: `python -m symofros.description.schema`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import Self, TypeAliasType

from symofros.description.parser import MAX_LENGTH
from symofros.description.system import WAIVERS, WORLD, Frame, Inertia, Input, Joint, JointKind, Limits
from symofros.description.system import Parameter, RigidBody
from symofros.description.values import IDENTITY, ORIGIN, Rotation, RotationKind, Value, as_value
from symofros.errors import DescriptionError, Problem, did_you_mean

VERSION = 1
SCHEMA_FILE = Path(__file__).with_name("schema.json")
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
