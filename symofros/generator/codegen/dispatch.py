"""The C file that chooses among versions of a model for several kinds of processors."""

from __future__ import annotations

from string import Template

from symofros.native import native_text
from symofros.runtime.build.toolchain import kinds


def dispatch_source(symbol: str) -> str:
    """The C file whose exported function returns the model for the processor that it runs on.

    Args:
        symbol: The exported function; that of each kind of processor has the kind's name behind it.
    """
    *better, (last, _, _) = kinds()
    choices = [f"    if ({' && '.join(map(_has, needs))}) return {symbol}_{name}();" for name, needs, _ in better]
    return Template(native_text("model/dispatch.c.in")).substitute(
        symbol=symbol,
        last=last,
        declarations="\n".join(f"const sym_model *{symbol}_{name}(void);" for name, _, _ in kinds()),
        choices="\n".join(["    __builtin_cpu_init();", *choices] if choices else []),
    )


def _has(feature: str) -> str:
    return f'__builtin_cpu_supports("{feature}")'
