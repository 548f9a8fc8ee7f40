"""Arrays on the device are taken where they lie if they are of the kernels' type, and refused if they are not."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.cuda.arrays import DeviceArray, placed
from symofros.runtime.cuda.driver import Driver
from tests.runtime.cuda.foreign_arrays import OnDevice


@pytest.mark.parametrize("stated", ["float32", "float64", "int32"])
@pytest.mark.parametrize("wanted", ["float32", "float64"])
def test_an_array_of_the_device_is_of_the_type_that_is_wanted(device: Driver, stated: str, wanted: str) -> None:
    """Ours and anybody's: the numbers of another type would be read wrong."""
    host = np.arange(6).reshape(2, 3).astype(stated)
    own = DeviceArray(device, host.shape, host.dtype)
    own.write(host)
    for array, strides in ((own, (1, 2)), (OnDevice(host), (3, 1))):
        if stated == wanted:
            taken = placed("q", array, wanted, device)
            assert taken.owner is array and taken.shape == (2, 3) and taken.strides == strides
        else:
            with pytest.raises(sf.ShapeError, match="q"):
                placed("q", array, wanted, device)
    copied = placed("q", host, wanted, device)  # Of the host: numbers are converted.
    assert copied.owner.dtype == wanted and np.array_equal(copied.owner.numpy(), host)
