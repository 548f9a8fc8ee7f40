"""C text to libraries: compilers, the cache, what is known to be compiled."""

from __future__ import annotations

from symofros.runtime.build.build import build_library as build_library
from symofros.runtime.build.cache import cache_folder as cache_folder
from symofros.runtime.build.cache_size import LIMIT_VARIABLE as LIMIT_VARIABLE
from symofros.runtime.build.cache_size import Pruned as Pruned
from symofros.runtime.build.cache_size import entries as entries
from symofros.runtime.build.cache_size import limit as limit
from symofros.runtime.build.cache_size import prune as prune
from symofros.runtime.build.prepared import note_prepared as note_prepared
from symofros.runtime.build.prepared import recall_prepared as recall_prepared
from symofros.runtime.build.toolchain import NO_COMPILER as NO_COMPILER
from symofros.runtime.build.toolchain import Toolchain as Toolchain
from symofros.runtime.build.toolchain import call_compiler as call_compiler
from symofros.runtime.build.toolchain import find_toolchain as find_toolchain
