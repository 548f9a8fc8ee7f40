"""Where commands print what Rich lays out: tables, trees, progress."""

from __future__ import annotations

from rich.console import Console

out = Console()
err = Console(stderr=True)
