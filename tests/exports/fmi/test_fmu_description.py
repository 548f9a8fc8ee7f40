"""The text of modelDescription.xml, by itself."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from symofros.base import units
from symofros.exports.fmi.fmu_description import Unit, description_xml
from symofros.exports.fmi.fmu_variables import Variable
from symofros.exports.material import Stepping
from symofros.simulation.stepping.methods import METHODS

# As FMI writes it -> as this package does; "" of a text that is no unit, as those of parameters may be.
STATED = {"deg/s": "deg/s", "N.m/rad": "N m/rad", "kN": "kN", "rad/s2": "rad/s^2", "%": "%", "V": "V", "any words": ""}


@pytest.mark.parametrize("version", [2, 3])
def test_units_are_declared_by_those_of_si(version: int) -> None:
    """So that importers convert degrees where radians are asked for, or refuse them."""
    listed = [Variable(i, f"x{i}", "output", "continuous", unit=unit) for i, unit in enumerate(STATED)]
    unit = Unit("units", "units", "", "", Stepping(METHODS["rk4"], 1e-3, 1e-6, 1e-9), 0.1, ())
    text = description_xml(unit, listed, version, "{}", "2026-11-30T00:00:00Z")
    declared = {one.attrib["name"]: one.find("BaseUnit") for one in ElementTree.fromstring(text.encode()).iter("Unit")}
    assert declared.keys() == STATED.keys() and declared.pop("any words") is None
    for name, base in declared.items():
        assert base is not None, name
        powers = tuple(int(base.get(one, "0")) for one in units.BASE)
        assert units.Unit(float(base.get("factor", "1")), powers) == units.parse(STATED[name])
