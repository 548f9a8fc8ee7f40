"""Edges of the graph: signed integers. `+n` is the value of node n, `-n` its negation."""

from __future__ import annotations

Edge = int
ZERO: Edge = 0
ONE: Edge = 1
