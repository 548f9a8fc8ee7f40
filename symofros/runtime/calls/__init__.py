"""Functions of models as they are called: kernels, their signatures and libraries, memory that C points to."""

from __future__ import annotations

from symofros.runtime.calls.binding import NativeMemory as NativeMemory
from symofros.runtime.calls.binding import constants as constants
from symofros.runtime.calls.binding import native_library as native_library
from symofros.runtime.calls.binding import native_library_is_loaded as native_library_is_loaded
from symofros.runtime.calls.extension import step_type as step_type
from symofros.runtime.calls.interpreted import InterpretedFunction as InterpretedFunction
from symofros.runtime.calls.kernel import Kernel as Kernel
from symofros.runtime.calls.kernel import LaneOptions as LaneOptions
from symofros.runtime.calls.kernel import Precision as Precision
from symofros.runtime.calls.kernel import Signature as Signature
from symofros.runtime.calls.kernel import Unit as Unit
from symofros.runtime.calls.layout import flat as flat
from symofros.runtime.calls.library import MANY as MANY
from symofros.runtime.calls.library import CompiledKernel as CompiledKernel
from symofros.runtime.calls.library import CompiledUnit as CompiledUnit
from symofros.runtime.calls.sharing import together as together
