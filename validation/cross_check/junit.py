"""Results in the JUnit form that continuous integration servers read."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence

from ..checking import ModelResult
from ..comparison.errors import Comparison
from .baseline import Regression

# What XML 1.0 has no way to write; messages may quote anything.
_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def to_junit(models: Sequence[ModelResult], seconds: float, regressions: Sequence[Regression] = ()) -> str:
    """One suite a model, one case a comparison; a suite of what is worse than in a stored run.

    Args:
        models: Outcomes; the time of a suite is that of all stages of its check.
        seconds: Time of the whole run [s].
        regressions: What is worse than in a stored run.
    """
    root = ElementTree.Element("testsuites", name="symofros cross-check", time=f"{seconds:.1f}")
    for model in models:
        _suite(root, model)
    if regressions:
        count = str(len(regressions))
        suite = ElementTree.SubElement(root, "testsuite", name="baseline", tests=count, failures=count)
        suite.attrib |= {"errors": "0", "skipped": "0"}
        for worse in regressions:
            cell = {
                "classname": f"baseline.{worse.model}",
                "name": " ".join(filter(None, (worse.quantity, worse.engine))),
            }
            ElementTree.SubElement(
                ElementTree.SubElement(suite, "testcase", cell), "failure", message=f"{worse.kind}: {worse.text}"
            )
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + _ILLEGAL.sub("?", text) + "\n"


def _suite(root: ElementTree.Element, model: ModelResult) -> None:
    rows = model.comparisons
    counts = {
        "tests": len(rows),
        "failures": sum(row.status == "disagree" for row in rows),
        "errors": sum(row.status == "failed" for row in rows),
        "skipped": sum(row.status == "unsupported" for row in rows),
    }
    stated = {"name": model.label, **{key: str(value) for key, value in counts.items()}}
    suite = ElementTree.SubElement(root, "testsuite", stated, time=f"{sum(model.seconds.values()):.3f}")
    for row in rows:
        case = ElementTree.SubElement(suite, "testcase", classname=f"{row.model}.{row.engine}", name=row.quantity)
        _verdict(case, row)


def _verdict(case: ElementTree.Element, row: Comparison) -> None:
    if row.status == "disagree":
        message = f"error {row.error} exceeds {row.tolerance} in state {row.worst_state} of {row.states}"
        ElementTree.SubElement(case, "failure", message=f"{message}; {row.note}" if row.note else message)
    elif row.status == "failed":
        ElementTree.SubElement(case, "error", message=row.note)
    elif row.status == "unsupported":
        ElementTree.SubElement(case, "skipped", message=row.note)
