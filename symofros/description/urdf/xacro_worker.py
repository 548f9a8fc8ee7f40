"""A process that expands one xacro file: a script of its own, which knows nothing of the rest of this package.

xacro evaluates Python expressions and opens what a file names. Here an expression is arithmetic, comparisons, indexing
and calls of the functions of ALLOWED; files are opened inside of one folder only; XML has no document types; memory,
time and environment are bounded. It reads {"file", "folder", "arguments"} as JSON, and writes {"text"} or {"fault"}.
"""

from __future__ import annotations

import ast
import json
import math
import os
import sys
import xml.dom.expatbuilder  # noqa: F401 - loaded before files are guarded
import xml.dom.minidom
from typing import Any
from xml.parsers import expat

MAX_BYTES = 16 << 20
MEMORY = 2 << 30  # [bytes]
SECONDS = 20  # of processor time

_FUNCTIONS = (
    "abs all any arg bool dict enumerate float int len list max min round sorted range str sum tuple zip "
    "load_yaml dotify tokenize warning error message fatal"
)
ALLOWED = frozenset(_FUNCTIONS.split()) | {name for name in dir(math) if not name.startswith("_")}
_SPACES = frozenset({"math", "python", "xacro"})
_NODES = (
    *(ast.Expression, ast.Constant, ast.Name, ast.Load, ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp),
    *(ast.operator, ast.unaryop, ast.boolop, ast.cmpop, ast.Call, ast.keyword, ast.Attribute, ast.Subscript, ast.Slice),
    *(ast.List, ast.Tuple, ast.Dict),
)


class Refusal(Exception):
    """What a file may not do."""


def vet(expression: str) -> None:
    """Refuse an expression that does more than compute.

    Raises:
        Refusal: It does, and what.
        SyntaxError: It is none.
    """
    for node in ast.walk(ast.parse(expression.strip(), mode="eval")):
        if not isinstance(node, _NODES):
            raise Refusal(f"'{expression:.80}': {type(node).__name__} is not allowed in an expression")
        name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
        if name.startswith("_"):
            raise Refusal(f"'{expression:.80}': names that begin with '_' are not allowed")
        if isinstance(node, ast.Call) and not _may_call(node.func):
            raise Refusal(f"'{expression:.80}': '{ast.unparse(node.func):.40}' may not be called")


def _may_call(function: ast.expr) -> bool:
    if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
        return function.value.id in _SPACES and function.attr in ALLOWED
    return isinstance(function, ast.Name) and function.id in ALLOWED


def parsed(inp: Any, filename: str | None = None) -> Any:
    """What xacro parses, without document types: only they define entities.

    Raises:
        Refusal: A document type, or too many bytes.
    """
    if inp is None:
        with open(str(filename), "rb") as stream:
            inp = stream.read(MAX_BYTES + 1)
    if not isinstance(inp, str | bytes):
        return inp
    if len(inp) > MAX_BYTES:
        raise Refusal(f"'{filename}' has more than {MAX_BYTES} bytes")

    def doctype(name: str, *_: object) -> None:
        raise Refusal(f"document types are refused: <!DOCTYPE {name:.60}>")

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = doctype
    parser.Parse(inp, True)
    return xml.dom.minidom.parseString(inp)


def guard(folder: str) -> None:
    """From here on open files inside of a folder alone, and start nothing."""

    def hook(event: str, args: tuple[Any, ...]) -> None:
        if event in ("open", "os.listdir", "os.scandir"):
            path, mode = str(args[0]), args[1] if event == "open" else "r"
            real = os.path.realpath(os.fsdecode(args[0]) if isinstance(args[0], bytes) else path)
            inside = real == folder or real.startswith(folder + os.sep)
            if not inside or set(str(mode or "r")) & set("wax+"):
                raise Refusal(f"'{path:.100}' leaves the folder of the file")
        elif event.startswith(("os.", "subprocess.", "socket.", "shutil.", "ctypes.", "import")):
            raise Refusal(f"'{event}' is not allowed")

    sys.addaudithook(hook)


def bound() -> None:
    """Bound memory and time, where the system can."""
    try:
        import resource
    except ImportError:
        return
    for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_FSIZE, 0)):
        resource.setrlimit(what, (most, most))


def expanded(file: str, folder: str, arguments: dict[str, str]) -> str:
    """The text that xacro makes of a file.

    Args:
        file: Path of the file.
        folder: Folder that it may open files in, which `$(find NAME)` gives for the folder's own name.
        arguments: Values of <xacro:arg>.
    """
    import xacro
    import yaml  # noqa: F401 - loaded before files are guarded
    from xacro import substitution_args

    evaluate, substitute = xacro.safe_eval, substitution_args._eval

    def safe_eval(expression: str, *scopes: Any) -> Any:
        vet(expression)
        return evaluate(expression, *scopes)

    def safe_substitution(expression: str, context: Any) -> Any:
        vet(expression)
        return substitute(expression, context)

    def find(name: str) -> str:
        if name != os.path.basename(folder):
            raise Refusal(f"$(find {name:.60}): packages other than that of the file, '{folder}', are not looked for")
        return folder

    xacro.safe_eval, xacro.parse = safe_eval, parsed
    substitution_args._eval, substitution_args._eval_find = safe_substitution, find
    os.environ.clear()
    bound()
    guard(folder)
    document = xacro.process_file(file, mappings=dict(arguments))
    text = str(document.toprettyxml(indent=" "))
    if len(text) > MAX_BYTES:
        raise Refusal(f"it expands to {len(text)} characters, more than {MAX_BYTES}")
    return text


def main() -> None:
    """Expand what is asked for."""
    task = json.load(sys.stdin)
    try:
        answer = {"text": expanded(task["file"], task["folder"], task["arguments"])}
    except ImportError:
        answer = {"absent": "xacro"}
    except BaseException as error:  # Also what is no Exception: the parent says it, whatever it is.
        causes: list[str] = []
        cause: BaseException | None = error
        while cause is not None and len(causes) < 5:
            causes.append(str(cause).strip() or type(cause).__name__)
            cause = getattr(cause, "exc", None) or cause.__cause__
        answer = {"fault": "; ".join(dict.fromkeys(causes))}
    sys.stdout.write(json.dumps(answer))


if __name__ == "__main__":
    main()
