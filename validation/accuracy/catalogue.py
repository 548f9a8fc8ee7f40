"""The studies of the report, in its order."""

from __future__ import annotations

from validation.accuracy import elastica, spinning
from validation.accuracy.findings import Asked

STUDIES: dict[str, Asked] = {
    "spinning": spinning.study,
    "elastica": elastica.study,
}
