"""Kinds of the factors of a configuration manifold."""

from __future__ import annotations

from typing import Literal

# "linear": q' = v; "quaternion": orientation of a ball joint; "pose": position and quaternion of a free joint.
ManifoldKind = Literal["linear", "quaternion", "pose"]
