"""Reference numbers of beams."""

from __future__ import annotations

from pathlib import Path

from validation.evidence.reference import References

BEAMS = References(Path(__file__).parent / "data")
data, source = BEAMS.data, BEAMS.source
