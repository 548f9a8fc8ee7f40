"""NAME_functions.h and NAME.hpp: functions with named arguments in C, and with Eigen's maps in C++."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import prod
from string import Template
from textwrap import wrap

from symofros.base.names import function_symbols
from symofros.exports.functions import NamedFunction
from symofros.exports.material import Material
from symofros.native import native_text

# Passed by value, not as an array of one.
_NUMBER = "t"
_WIDTH = 120


def named_functions(material: Material) -> list[NamedFunction]:
    """The functions of a package under their names in C, in the order of its table."""
    symbols = function_symbols(material.c_name, material.functions)
    return list(map(NamedFunction, symbols, material.signatures))


def typed_text(material: Material) -> str:
    """NAME_functions.h."""
    texts = [_in_c(material.c_name, i, function) for i, function in enumerate(named_functions(material))]
    return _filled("exports/functions.h.in", material, "\n\n".join(texts))


def eigen_text(material: Material) -> str:
    """NAME.hpp."""
    functions = named_functions(material)
    methods = function_symbols("", material.functions)
    starts = _starts(functions)
    texts = [
        _in_cpp(function, method.removeprefix("_"), at)
        for function, method, at in zip(functions, methods, starts, strict=True)
    ]
    return _filled("exports/eigen.hpp.in", material, "\n\n".join(texts), size=max(1, sum(map(_size, functions))))


def _filled(template: str, material: Material, functions: str, **more: object) -> str:
    name = material.c_name
    fields = {"name": name, "upper": name.upper(), "generator": material.generator, "functions": functions}
    return Template(native_text(template)).substitute(fields | more)


def _in_c(name: str, index: int, function: NamedFunction) -> str:
    """One function with named arguments, sizes beside them."""
    inputs, outputs = function.signature.inputs, function.signature.outputs
    arguments = ["const double *pre"]
    arguments += [f"double {x}" if x == _NUMBER else f"const double *{x} /* {size} */" for x, size in inputs]
    arguments += [f"double *{x} /* {_shape(shape)} */" for x, shape in outputs]
    given = ", ".join(["pre", *(f"&{x}" if x == _NUMBER else x for x, _ in inputs)])
    assigned = [f"    in[{k}] = {text};" for k, text in enumerate(given.split(", "))]
    assigned += [f"    out[{k}] = {x};" for k, (x, _) in enumerate(outputs)]
    return "\n".join(
        [
            f"/* {function.summary} */",
            _wrapped(f"static inline void {function.symbol}({', '.join([*arguments, 'double *work'])}) {{"),
            f"    const double *in[{len(inputs) + 1}];",
            f"    double *out[{len(outputs)}];",
            *assigned,
            f"    {name}_model()->functions[{index}].eval(in, out, work);",
            "}",
        ]
    )


def _in_cpp(function: NamedFunction, method: str, start: int) -> str:
    """One function as a method that returns maps of the object's memory."""
    inputs, outputs = function.signature.inputs, function.signature.outputs
    arguments = [
        "double t = 0.0" if x == _NUMBER else f"const Eigen::Ref<const Array<{size}>> &{x}" for x, size in inputs
    ]
    # What has a default comes last.
    arguments.sort(key=lambda text: "=" in text)
    places, at = [], start
    for _, shape in outputs:
        places.append(f"out_.data() + {at}")
        at += prod(shape)
    given = ["pre_.data()", *(x if x == _NUMBER else f"{x}.data()" for x, _ in inputs), *places, "work_.data()"]
    maps = [f"Array<{_dimensions(shape)}>" for _, shape in outputs]
    returned = ", ".join(f"Eigen::Map<const {kind}>({place})" for kind, place in zip(maps, places, strict=True))
    result = f"{method}_result"
    return "\n".join(
        [
            f"    struct {result} {{",
            *(f"        Eigen::Map<const {kind}> {x};" for (x, _), kind in zip(outputs, maps, strict=True)),
            "    };",
            f"    /* {function.summary} */",
            _wrapped(f"    {result} {method}({', '.join(arguments)}) {{"),
            _wrapped(f"        {function.symbol}({', '.join(given)});"),
            _wrapped(f"        return {{{returned}}};"),
            "    }",
        ]
    )


def _wrapped(line: str) -> str:
    """A line of code in lines of bounded width."""
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    parts = wrap(line, _WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return "\n".join(parts)


def _starts(functions: Sequence[NamedFunction]) -> Iterable[int]:
    """Offset of the results of each function in the object's memory."""
    at = 0
    for function in functions:
        yield at
        at += _size(function)


def _size(function: NamedFunction) -> int:
    return sum(prod(shape) for _, shape in function.signature.outputs)


def _dimensions(shape: tuple[int, ...]) -> str:
    return ", ".join(map(str, shape or (1,)))


def _shape(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape or (1,)))
