"""Run-time parameters of a model: values, and whether they are judged."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Self

import numpy as np

from symofros.base.arrays import real_array
from symofros.errors import ParameterError, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import Functions


class ParameterFunctions(Functions):
    """Methods of a model that read or replace its run-time parameters."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Name -> value of the run-time parameters."""
        return MappingProxyType(dict(zip(self.record.par_names, self._par.tolist(), strict=True)))

    def with_parameters(self, **values: float) -> Self:
        """The same compiled code with other parameter values, judged by the conditions of the description.

        Raises:
            UnknownNameError: No such run-time parameter.
            ParameterError: A value is not a finite number, or the description refuses it (a negative mass).
        """
        par = self._par.copy()
        for name, value in values.items():
            if name not in self.record.par_names:
                raise self._unknown(
                    "run-time parameter",
                    name,
                    self.record.par_names,
                    "constants are hard-coded: change them in the description",
                )
            par[self.record.par_names.index(name)] = self._finite(name, value)
        return self._like(par=self.checked_parameters(par))

    @property
    def parameter_values(self) -> Array:
        """The run-time parameters (npar), read-only."""
        return self._par

    def with_parameter_checks(self, checks: bool) -> Self:
        """The same model, whose run-time parameters are judged by the description's conditions, or taken as they come.

        They are judged wherever they enter: `with_parameters`, `par=` of functions, of simulations and of batches. That
        takes a microsecond where they are those of the call before, otherwise some hundred and, in batches, about ten a
        state: loops that change them at every call may leave it out.

        Raises:
            SymofrosError: The model came without its description.
        """
        if not checks:
            other = self._like()
            other._parameter_check = None
            return other
        if self._parameter_check is None:
            raise SymofrosError(
                f"model '{self.record.name}': nothing is known of its parameters",
                "checks that were left out, or a model without its description",
                "a compiled model checks its parameters unless that is turned off",
                "use the model that with_parameter_checks(False) was called on",
            )
        return self._like()

    def _finite(self, name: str, value: float) -> float:
        number = real_array(value)
        if number is None or number.shape != () or not np.isfinite(number):
            what = f"model '{self.record.name}': parameter '{name}' is not a finite number"
            raise ParameterError(
                what,
                repr(value)[:80],
                "a parameter is one finite number",
                "pass par=… to a function for values that vary by state",
            )
        return float(number)
