"""The models that identities are tested on: one of each kind of structure, and random trees."""

from __future__ import annotations

from functools import cache

import symofros as sf
from tests.trees import KINDS, MORE_KINDS, parametrised, random_tree

CASES = {f"tree{seed}": seed for seed in range(8)}
CASES |= {f"parametrised{seed}": seed for seed in range(3)}
CASES |= {f"joints{seed}": 100 + seed for seed in range(8)}


@cache
def system(case: str) -> sf.System:
    tree = random_tree(CASES[case], kinds=MORE_KINDS if case.startswith("joints") else KINDS)
    return parametrised(tree) if case.startswith("parametrised") else tree


@cache
def model(case: str, backend: str = "interpreter") -> sf.Model:
    """The model of a case; the interpreter is the default because identities don't need speed."""
    return sf.compile(system(case), sf.Options(backend=backend))
