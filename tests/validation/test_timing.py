"""The timing harness reads what the native program prints, and times nothing that disagrees."""

from __future__ import annotations

from dataclasses import asdict

import pytest
from validation.studies.native_build import BuildError
from validation.studies.timing import FUNCTIONS, TimingRun, _read, models, time_model, tree_text
from validation.studies.timing_mujoco import time_mujoco
from validation.studies.timing_mujoco_report import mujoco_lines
from validation.studies.timing_report import as_data, as_markdown

import reference_models
from validation.assembly import assemble

OUTPUT = "error mass_matrix {error}\nerror bias 1e-15\n" + "".join(
    f"time {function} {side} {repeat} {nanoseconds + repeat}\n"
    for function in ("mass_matrix", "bias", "mass_matrix_and_bias", "mass_matrix_and_bias_batch")
    for side, nanoseconds in (("symofros", 100), ("pinocchio-local", 500), ("pinocchio-world", 400))
    for repeat in range(3)
)


def test_ratios_are_taken_pair_by_pair_against_the_faster_side() -> None:
    timings = _read("arm", 7, "g++ 12", OUTPUT.format(error="2e-15"))
    assert [timing.function for timing in timings] == [*FUNCTIONS[:4]]
    assert timings[0].ours == (100, 101) and timings[0].theirs == (400, 401)
    assert timings[0].ratio == pytest.approx(401 / 101)


def test_sides_that_disagree_are_not_timed() -> None:
    with pytest.raises(BuildError, match="disagree by 1.0e-06"):
        _read("arm", 7, "g++ 12", OUTPUT.format(error="1e-6"))


def test_a_model_goes_over_as_numbers() -> None:
    text = tree_text(assemble(reference_models.MODELS["open_chain_5r"])).splitlines()
    assert text[0] == "symofros-tree 1" and text[2] == "bodies 5"
    # body, parent, kind, axis 3, R 9, p 3, mass, p_BC 3, J 9, moments 3, axes 9
    assert [len(line.split()) for line in text[3:]] == [3 + 3 + 9 + 3 + 1 + 3 + 9 + 3 + 9] * 5


def test_panda_is_timed_with_seven_joints() -> None:
    assert assemble(models()["panda, 7 joints"]).nv == 7


def test_the_report_states_ratio_flags_and_limits() -> None:
    run = TimingRun(_read("arm", 7, "g++ 12", OUTPUT.format(error="2e-15")), ["chain: no compiler"])
    text = as_markdown(as_data(run, 3, [0.1, 1.25]))
    assert "Load of the machine before and after: 0.1 and 1.2" in text
    assert "**3.97**" in text and "-O3" in text and "One thread" in text and "Not timed: chain" in text


@pytest.mark.slow
def test_the_native_program_agrees_with_the_generated_code() -> None:
    from validation.studies.native_build import build, compilers

    pytest.importorskip("cmeel")
    timings = time_model("chain7", reference_models.MODELS["chain7"], build(compilers()[0]), 3)
    assert len(timings) == 4 and all(timing.error < 1e-12 for timing in timings)


def test_mujoco_on_a_small_arm() -> None:
    rows = time_mujoco("ur5", models()["ur5"], 3)
    assert [row.function for row in rows] == ["M", "M + h", "forward dynamics"]
    assert all(0 < row.ours[0] <= row.ours[1] and 0 < row.theirs[0] and row.ratio > 0 for row in rows)
    assert "| ur5 | 6 | forward dynamics |" in "\n".join(mujoco_lines([asdict(row) for row in rows]))
