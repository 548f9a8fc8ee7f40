"""Pinocchio: models by its API, their functions, constraints, and files that it reads."""

from __future__ import annotations

from .functions import WAYS as WAYS
from .model import CLOSING as CLOSING
from .model import write as write
from .plugin import PLUGIN as PLUGIN
