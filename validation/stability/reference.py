"""Reference numbers of the atlas."""

from __future__ import annotations

from pathlib import Path

from ..reporting.references import References

ATLAS = References(Path(__file__).parent / "data")
data, source = ATLAS.data, ATLAS.source
