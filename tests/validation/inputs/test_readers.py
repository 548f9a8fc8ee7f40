"""What workers are forked with: readers of descriptions, and no engine."""

from __future__ import annotations

import subprocess
import sys

_PROGRAM = """
import sys
import validation.inputs.readers
from validation.inputs.cases import file_case
engines = {"pinocchio", "mujoco", "exudyn"} & set(sys.modules)
before = set(sys.modules)
file_case("battery").load(), file_case("sampler").load()
print(sorted(engines), sorted(set(sys.modules) - before))
"""


def test_reading_a_model_imports_nothing_anew_and_no_engine() -> None:
    done = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] []"
