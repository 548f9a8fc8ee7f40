"""Scripts keep what they use and what may act; what nothing names is left out."""

from __future__ import annotations

from pathlib import Path

from validation.engines.proving.pruning import pruned

ROOT = Path(__file__).parents[3]

SCRIPT = '''"""Head."""

import numpy as np
from engine import plant, unused
from engine import other
import engine.parsers
LONG = """
def inertia(): text
"""
zero = np.array([0.0, 1.0])
def inertia(mass):
    return other.Inertia(mass, zero)
def pose(p):
    return plant.pose(p)
c = plant.context()
q = np.array([1.0])
value = pose(q)
assert value <= 1
'''


def test_what_only_unused_functions_name_goes_with_them() -> None:
    assert pruned(SCRIPT) == (
        '"""Head."""\n\nimport numpy as np\nfrom engine import plant, unused\ndef pose(p):\n    return plant.pose(p)\n'
        "c = plant.context()\nq = np.array([1.0])\nvalue = pose(q)\nassert value <= 1\n"
    )


def test_scripts_of_the_report_have_nothing_left_to_drop() -> None:
    for path in sorted((ROOT / "reports" / "engines").glob("*.py")):
        text = path.read_text()
        compile(text, path.name, "exec")
        assert pruned(text) == text, path.name
