from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.commands.reading import ReadingOptions, reading_of
from tests.validation.subjects import URDF
from validation.inputs.cases import Case, file_case, named
from validation.inputs.sampling import DEFAULT_STATES


def test_files_of_the_standard_set_turn_inertias_where_it_counts() -> None:
    """A reader that leaves the rotation of <inertial> out would give another M."""
    system = file_case("sampler").load().system
    stated, plain = (
        sf.compile(each, sf.Options(("mass_matrix",), backend="interpreter"))
        for each in (
            system,
            replace(
                system,
                bodies=tuple(
                    replace(body, inertia=body.inertia and replace(body.inertia, rotation=sf.Rotation()))
                    for body in system.bodies
                ),
            ),
        )
    )
    M, q = stated.mass_matrix(stated.neutral()), plain.neutral()
    assert np.abs(M - plain.mass_matrix(q)).max() > 1e-3 * np.abs(M).max()


def test_states_leave_a_tail_behind_vectors_of_every_width() -> None:
    assert all(DEFAULT_STATES % lanes for lanes in (2, 4, 8))


def test_cases_have_distinct_labels_are_taken_once_and_must_be_known(tmp_path: Path) -> None:
    for names, labels in (
        (["a/arm.urdf", "b/arm.urdf"], ["a/arm.urdf", "b/arm.urdf"]),
        (["ur5", "a/arm.urdf", "ur5", "a/arm.urdf"], ["ur5", "arm"]),
    ):
        assert [case.label for case in named(names)] == labels
    with pytest.raises(LookupError, match="did you mean 'panda'"):
        named(["pandas"])


def test_files_and_names_can_be_mixed(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    cases = named([str(path), "ur5", "some.yaml"], ReadingOptions(floating_base=True))
    assert [case.label for case in cases] == ["arm", "ur5", "some"]
    assert [case.reading.floating_base for case in cases] == [True, False, False]


@pytest.mark.parametrize(
    ("names", "reading", "said"),
    [
        (["pendulum"], {"waive": ["bogus"]}, "no check 'bogus'"),
        (["pendulum"], {"waive": ["massless_tip"]}, "options of reading"),
        ([], {"mimic": True}, "options of reading"),
        (["a.yaml", "ur5"], {"floating_base": True}, "floating_base"),
        (["a.yaml"], {"packages": ["a=b"]}, "packages"),
        (["a.urdf"], {"arguments": ["a=b"], "mimic": True}, "found: arguments"),
    ],
)
def test_options_that_fit_no_file_are_refused(names: list[str], reading: dict[str, Any], said: str) -> None:
    with pytest.raises(sf.SymofrosError) as caught:
        named(names, reading_of(**reading))
    assert said in " ".join(str(caught.value).split())


@pytest.mark.parametrize("floating_base", [False, True])
def test_a_urdf_brings_its_text_and_its_digits(tmp_path: Path, floating_base: bool) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.replace('rpy="0.3 0 0"', 'rpy="1e-15 0 0"'))
    subject = Case("arm", path, ReadingOptions(floating_base)).load()
    assert subject.urdf is not None and subject.urdf.text == path.read_bytes()
    assert subject.urdf.verbatim != subject.system
    assert any(b.joint and b.joint.kind == "free" for b in subject.system.bodies) == floating_base


@pytest.mark.parametrize("reading", [ReadingOptions(dissipation="viscous"), ReadingOptions(limits="stops")])
def test_engines_that_read_urdf_skip_models_with_other_forces(tmp_path: Path, reading: ReadingOptions) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    assert Case("arm", path, reading).load().urdf is None
