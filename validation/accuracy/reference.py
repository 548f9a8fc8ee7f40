"""Reference numbers of beams."""

from __future__ import annotations

from pathlib import Path

from ..reporting.references import References

BEAMS = References(Path(__file__).parent / "data")
data, source = BEAMS.data, BEAMS.source
