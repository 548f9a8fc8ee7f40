"""NAME_efforts.c: efforts of chosen actuators, and names of joints and of prescribed speeds."""

from __future__ import annotations

from string import Template

from symofros.base.c_text import comment, doubles, integers, strings
from symofros.exports.material import Material
from symofros.generator import ROUTINES
from symofros.native import native_text


def efforts_text(material: Material) -> str:
    """C text of the efforts of actuators, with the routines of the constraints' null space."""
    record = material.record
    group, unit, speed = record.measures
    fields = {
        "name": material.c_name,
        "title": comment(record.name),
        "generator": material.generator,
        "routines": "\n".join(native_text(f"model/{file}.c.in") for file in ROUTINES["null_space_factors"]),
        "nv": len(record.v_names),
        "nc": record.nc,
        "nu": len(record.u_names),
        "efforts": len(record.u_names) - record.driven,
        "group": integers(group),
        "unit": integers(unit),
        "speed": integers(speed),
        "joints": strings(record.joint_names),
        "prescribed": strings(record.prescribed_names),
        "section_beams": strings([beam for beam, _ in record.section_names]),
        "section_stations": doubles([xi for _, xi in record.section_names]),
    }
    return Template(native_text("exports/actuator_efforts.c.in")).substitute(fields)
