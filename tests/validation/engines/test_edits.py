"""Files of one feature and of two: what they mean, that each shows, whose causes a file of two has."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from validation.engines.causes.cause import Cause
from validation.engines.models.covering import edits, mjcf_files, mjcf_meaning, sdf_files, urdf_files, usd_files
from validation.engines.models.files.readers import Reading
from validation.engines.verdicts import Cell

_FORMS = {"urdf": urdf_files, "mjcf": mjcf_files, "sdf": sdf_files, "usd": usd_files}
_FILES: dict[str, Mapping[str, Reading]] = {form: made.files() for form, made in _FORMS.items()}
# What no number of the mechanism shows.
_SILENT = {
    "urdf": "axis of length 2, base link of another name, base link with mass, children before parents, elements in"
    " another order, elements of other programs, joints named as their links, losses left out, numbers in other"
    " spellings, safety controller, shapes beside inertia",
    "mjcf": "actuators by default, axis of length 2, class of nothing before childclass, custom numbers and statistics,"
    " elements of a body turned round, elements of the first body turned round, geoms beside inertia, geoms beside"
    " inertia, inertiafromgeom false, geoms of the world, materials and textures, range without limits: limited false,"
    " range without limits: limited false, autolimits false, range without limits: zeros, range without limits: zeros,"
    " limited auto, sections turned round, sites, cameras and lights",
    "sdf": "a frame for parent, axis of length 2, children before parents, pose relative to its joint, shapes beside"
    " inertia",
    "usd": "direction of gravity of length 2, kilograms left out, magnitude of gravity left out, up along Y,"
    " up axis left out",
}


def _names(form: str, pairs: bool) -> list[str]:
    return [name for name in _FILES[form] if (edits.BETWEEN in name) == pairs]


@pytest.mark.parametrize("form", _FORMS)
def test_each_feature_changes_the_tree_or_is_named_as_one_that_does_not(form: str) -> None:
    def numbers(reading: Reading) -> str:
        tree = reading.tree
        return repr((tree.links, tree.gravity, tree.tendons, tree.actuators, tree.sensors))

    plain = numbers(_FILES[form][f"{form}: plain"])
    silent = [name.partition(": ")[2] for name in _names(form, False) if numbers(_FILES[form][name]) == plain]
    assert sorted(", ".join(silent).split(", ")) == sorted(f"{_SILENT[form]}, plain".split(", "))


@pytest.mark.parametrize("form", _FORMS)
def test_pairs_are_of_two_factors_and_of_none_that_is_ruled_out(form: str) -> None:
    made = _FORMS[form]
    factors = {name: factor for factor, named in made.FEATURES.items() for name in named}
    for name in _names(form, True):
        one, other = name.removeprefix(f"{form}: ").split(edits.BETWEEN)
        assert factors[one] != factors[other]
        assert frozenset((one, other)) not in made.NEVER and frozenset((one, factors[other])) not in made.NEVER


def test_edits_state_drop_wrap_and_turn_round() -> None:
    text = '<a><b x="1"/><c/></a>'
    for edit, wanted in (
        (("b", {"x": "2"}), '<a><b x="2" /><c /></a>'),
        (("b", {"x": None}), "<a><b /><c /></a>"),
        (("b", "-"), "<a><c /></a>"),
        ((".", "+<d/>"), '<a><b x="1" /><c /><d /></a>'),
        ((".", "<d/>"), '<a><d /><b x="1" /><c /></a>'),
        (("c", "=<d/>"), '<a><b x="1" /><d /></a>'),
        (("c", "^<d><e/></d>"), '<a><b x="1" /><d><e><c /></e></d></a>'),
        ((".", "~"), '<a><c /><b x="1" /></a>'),
    ):
        assert edits.edited(text, [edit]) == wanted
    with pytest.raises(LookupError, match="no element at d"):
        edits.edited(text, [("d", "-")])


def test_a_file_of_two_features_has_the_causes_of_each() -> None:
    cause = Cause("drake", "c", "", "", "", ("mass_matrix",), trees=("urdf: one, written",))
    for model, explained in (
        ("urdf: one + two, written", True),
        ("urdf: two + one", False),
        ("urdf: one, written", True),
    ):
        assert cause.explains(Cell("drake", model, "mass_matrix", "wrong")) is explained


def test_meanings_turn_about_the_axes_that_they_state() -> None:
    tree = mjcf_meaning.meaning(_FILES["mjcf"]["mjcf: quat of length 2"].text)
    place = tree.links[1].joints[0]
    # Of the unit quaternion (1, 2, -2, 4) / 5: R x = x + 2 w (u x x) + 2 u x (u x x).
    w, u = 0.2, np.array([0.4, -0.4, 0.8])
    x = np.array([1.0, 0.0, 0.0])
    turned = x + 2.0 * w * np.cross(u, x) + 2.0 * np.cross(u, np.cross(u, x))
    assert np.allclose(np.array(place.R) @ x, turned, atol=1e-15)
