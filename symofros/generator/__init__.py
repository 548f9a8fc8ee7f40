"""Stages between equations and model; here what wings take: programs optimised, counted, written in C, interpreted."""

from __future__ import annotations

from symofros.generator.codegen.interpreted import FormulaInstants as FormulaInstants
from symofros.generator.codegen.interpreted import InterpretedUnit as InterpretedUnit
from symofros.generator.codegen.model import model_source as model_source
from symofros.generator.codegen.solvers import ROUTINES as ROUTINES
from symofros.generator.codegen.tape import tape_unit as tape_unit
from symofros.generator.passes import run_passes as run_passes
from symofros.generator.passes.count import Operations as Operations
from symofros.generator.passes.count import count_operations as count_operations
from symofros.runtime.cuda.device_code import DeviceCode as DeviceCode
