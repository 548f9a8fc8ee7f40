"""Generated text does not depend on the machine: neither on its processor nor on what libraries choose for it.

Nor on the process: sets of strings have another order in each, by PYTHONHASHSEED. Processes also differ in the kernels
of OpenBLAS (OPENBLAS_CORETYPE), in the vector instructions of NumPy (NPY_DISABLE_CPU_FEATURES) and in those of the C
library's functions (GLIBC_TUNABLES). Where a library does not read its variable, the processes are alike.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from tests.generator.text_digests import digests

# Vector instructions that NumPy found on this machine, by any of the names that its versions have for them.
FOUND: list[str] = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])  # type: ignore[index]
AVX2 = bool({"AVX2", "X86_V3"} & set(FOUND))
AVX512 = bool({"AVX512_SKX", "X86_V4"} & set(FOUND))
# OpenBLAS runs kernels that the processor lacks all the same, until an instruction is illegal.
CORES = {
    "Prescott": True,
    "Nehalem": True,
    "Sandybridge": AVX2,
    "Haswell": AVX2,
    "Zen": AVX2,
    "SkylakeX": AVX512,
}
NO_VECTORS = {"NPY_DISABLE_CPU_FEATURES": " ".join(FOUND)}
# Names of before and after glibc 2.33.
NO_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable,-FMA4_Usable"}


def digests_elsewhere(choice: str, variables: dict[str, str]) -> dict[str, str]:
    """Digests of texts that another process generates."""
    command = [sys.executable, "-m", "tests.generator.text_digests", choice]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, env=os.environ | variables, cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    result: dict[str, str] = json.loads(done.stdout)
    return result


def different(first: dict[str, str], second: dict[str, str]) -> list[str]:
    assert first.keys() == second.keys()
    return [name for name in first if first[name] != second[name]]


def test_the_order_of_sets_does_not_reach_the_text() -> None:
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        texts = list(threads.map(lambda seed: digests_elsewhere("diagrams", {"PYTHONHASHSEED": seed}), "01"))
    assert not different(*texts)


@pytest.mark.slow
def test_an_old_processor_generates_the_same_text() -> None:
    old = {"OPENBLAS_CORETYPE": "Prescott", **NO_VECTORS, **NO_FMA}
    with ThreadPoolExecutor(1) as thread:
        elsewhere = thread.submit(digests_elsewhere, "few", old)
        here = digests("few")
    assert not different(here, elsewhere.result())


@pytest.mark.slow
def test_all_models_have_the_same_text_on_every_processor() -> None:
    machines: dict[str, dict[str, str]] = {
        core: {"OPENBLAS_CORETYPE": core} for core, available in CORES.items() if available
    }
    machines |= {"NumPy without vectors": NO_VECTORS, "C library without FMA": NO_FMA}
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        texts = dict(
            zip(machines, threads.map(lambda name: digests_elsewhere("all", machines[name]), machines), strict=True)
        )
    first = next(iter(texts.values()))
    assert {name: different(first, text) for name, text in texts.items()} == dict.fromkeys(texts, [])
