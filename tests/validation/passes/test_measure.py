"""Leaving a pass out changes what is generated and not what is computed; the generator is whole again afterwards."""

from __future__ import annotations

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.tools import ABLATIONS, Ablation, count_program

# A model in which the pass has something to do.
WHERE = {"staging": "planar_robot", "rounding noise": "rx90", "constant factors": "planar_robot"}


def operations(name: str) -> int:
    return count_program(sf.program_of(MODELS[name], ("dynamics",)))["dynamics", ""].total


def text(name: str, options: sf.Options) -> str:
    path, _ = sf.compile_library(MODELS[name], options)
    return path.with_suffix(".c").read_text(encoding="utf-8") + path.name


LARGE = ("packs", "pieces")  # Passes that show in long chains.


@pytest.mark.parametrize(
    "one",
    [pytest.param(one, marks=[pytest.mark.slow] if one.name in LARGE else []) for one in ABLATIONS],
    ids=lambda one: one.name,
)
def test_a_pass_that_is_left_out_shows(one: Ablation) -> None:
    name = WHERE.get(one.name, "chain22" if one.name in LARGE else "puma560")
    plain = sf.Options(("dynamics",), batch="loop")
    whole, before = text(name, plain), operations(name)
    with one.without():
        assert operations(name) >= before
        assert text(name, one.options(plain)) != whole
    assert operations(name) == before
    assert text(name, plain) == whole
