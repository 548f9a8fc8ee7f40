"""A process that expands one xacro file: a script of its own, which knows of the rest of this package one module.

xacro gives expressions to Python's `eval` and opens what a file names. Here xacro_expressions evaluates them; files are
opened inside of the folders that it is given only; XML has no document types; memory, time and environment are bounded.
It reads {"file", "folders", "packages", "arguments"} as JSON, and writes {"text"}, or {"fault"} with the "package" that
is not known.
"""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import xml.dom.expatbuilder  # noqa: F401 - loaded before files are guarded
import xml.dom.minidom
from collections.abc import Collection, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.parsers import expat

MAX_BYTES = 16 << 20
MAX_FAULT = 2000  # Characters of what went wrong, of which the parent shows fewer.
MAX_CAUSES = 10
MAX_ENTRIES = 200_000  # Of a file of YAML.
OUTSIDE = "leaves the folders of the file"
MEMORY = 2 << 30  # [bytes]
SECONDS = 20  # of processor time


def _beside(name: str) -> ModuleType:
    """A module of this folder, which is not on the path of a script that runs isolated."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


expressions = _beside("xacro_expressions")


def parsed(inp: Any, filename: str | None = None) -> Any:
    """Parse a document for xacro; document types are refused, as only they define entities.

    Raises:
        Refusal: A document type, or too many bytes.
    """
    if inp is None:
        with open(str(filename), "rb") as stream:
            inp = stream.read(MAX_BYTES + 1)
    if not isinstance(inp, str | bytes):
        return inp
    if len(inp) > MAX_BYTES:
        raise expressions.Refusal(f"'{filename}' has more than {MAX_BYTES} bytes")

    def doctype(name: str, *_: object) -> None:
        raise expressions.Refusal(f"document types are refused: <!DOCTYPE {name:.60}>")

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = doctype
    parser.Parse(inp, True)
    return xml.dom.minidom.parseString(inp)


def guard(folders: Collection[str]) -> None:
    """Restrict this process: it opens files of some folders alone, to which the caller may add, and starts nothing."""
    writing = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND

    def hook(event: str, args: tuple[Any, ...]) -> None:
        if event in ("open", "os.listdir", "os.scandir"):
            path, mode, flags = str(args[0]), *(args[1:3] if event == "open" else ("r", 0))
            real = os.path.realpath(os.fsdecode(args[0]) if isinstance(args[0], bytes) else path)
            # A number is a file that is open already, such as standard input.
            near = any(real == folder or real.startswith(folder + os.sep) for folder in folders)
            inside = near and not isinstance(args[0], int)
            if inside and os.path.exists(real) and not (os.path.isfile(real) or os.path.isdir(real)):
                raise expressions.Refusal(f"'{path:.100}' is no regular file")  # A pipe would be waited for.
            if not inside or set(str(mode or "r")) & set("wax+") or flags & writing:
                raise expressions.Refusal(f"'{path:.100}' {OUTSIDE}")
        elif event.startswith(("os.", "subprocess.", "socket.", "shutil.", "ctypes.", "import")):
            raise expressions.Refusal(f"'{event}' is not allowed")

    sys.addaudithook(hook)


def bound() -> None:
    """Bound memory and time, where the system can."""
    try:
        import resource  # Windows has none.
    except ImportError:
        return
    for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_FSIZE, 0)):
        hard = resource.getrlimit(what)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)  # A bound that is set is never raised.
        try:
            resource.setrlimit(what, (least, least))
        except (OSError, ValueError):  # Not every system bounds the address space.
            continue


def expanded(file: str, folders: list[str], packages: Mapping[str, str], arguments: Mapping[str, str]) -> str:
    """The text that xacro makes of a file.

    Args:
        file: Path of the file.
        folders: Folders that it may open files in.
        packages: Name -> folder that `$(find NAME)` gives, in which files may be opened from then on.
        arguments: Values of <xacro:arg>.
    """
    import xacro  # An extra: its absence is the answer of `main`.
    import yaml  # noqa: F401 - loaded before files are guarded
    from xacro import substitution_args  # Of the same extra.

    functions = {
        "load_yaml": lambda file: unfolded(xacro.load_yaml(file), file),
        "dotify": xacro.YamlDictWrapper,
        "abs_filename": xacro.abs_filename_spec,
        "arg": lambda name: argument(xacro.substitution_args_context["arg"])(name),
    }

    def safe_eval(expression: str, symbols: Any, _: Any = None) -> Any:
        return expressions.Evaluator(symbols, functions, xacro.NameSpace)(expression)

    def substitution(expression: str, context: dict[str, Any]) -> str:
        known = {k: substitution_args.convert_value(v, "auto") for k, v in context.get("arg", {}).items()}
        known = {**known, **expressions.CONSTANTS}
        own = {"arg": argument(known), "find": find, "dirname": lambda: os.path.dirname(context["filename"])}
        return str(expressions.Evaluator(known, own, xacro.NameSpace)(expression))

    def argument(known: Mapping[str, Any]) -> Any:
        def value(name: str) -> Any:
            used.add(name)
            return known[name]

        return value

    def find(name: str) -> str:
        if name not in packages:
            raise expressions.Refusal(f"$(find {name:.60}): no such package", name)
        folders.append(packages[name])
        return packages[name]

    def opened(inp: Any, filename: str | None = None) -> Any:
        """Open a file that xacro includes; a missing one is xacro's error, which an optional include looks for."""
        try:
            document = parsed(inp, filename)
            if hasattr(document, "getElementsByTagName"):
                used.update(arg.getAttribute("name") for arg in document.getElementsByTagName("xacro:arg"))
            return document
        except OSError as error:
            xacro.filestack.pop()
            raise xacro.XacroException(f"{error.strerror}: {filename}", exc=error) from None

    folders, used = list(folders), set[str]()
    xacro.safe_eval, xacro.parse = safe_eval, opened
    substitution_args._eval, substitution_args._eval_find = substitution, find
    os.environ.clear()
    bound()
    guard(folders)
    document = xacro.process_file(file, mappings=dict(arguments))
    unused = [name for name in arguments if name not in used]
    if unused:
        declared = ", ".join(sorted(used)[:12]) or "none"
        raise expressions.Refusal(f"no <xacro:arg> is called '{unused[0]:.60}'; there are: {declared:.300}")
    return writable(document.toprettyxml(indent=" "))


def writable(text: str) -> str:
    """The text, if a file can hold it.

    Raises:
        Refusal: It is too long, or no Unicode.
    """
    if len(text) > MAX_BYTES:
        raise expressions.Refusal(f"it expands to {len(text)} characters, more than {MAX_BYTES}")
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise expressions.Refusal("it expands to a text with half of a surrogate pair, which no file holds")
    return str(text)


def unfolded(value: Any, file: str) -> Any:
    """A value of YAML, whose aliases stand for no more entries than a file may have.

    Raises:
        Refusal: They stand for more, or for a value within itself.
    """
    entries = 0
    levels = [iter([value])]
    while levels:
        item = next(levels[-1], levels)
        if item is levels:
            levels.pop()
            continue
        entries += 1
        if entries > MAX_ENTRIES or len(levels) > expressions.MAX_DEPTH:
            raise expressions.Refusal(
                f"'{file:.100}': with its aliases written out it has more than {MAX_ENTRIES} entries,"
                f" or more than {expressions.MAX_DEPTH} levels"
            )
        if isinstance(item, dict):
            levels.append(iter(list(dict.values(item))))
        elif isinstance(item, list):
            levels.append(list.__iter__(item))
    return value


def printable(text: str) -> str:
    """The beginning of a text, its control characters and surrogates escaped, for terminals and logs."""
    return "".join(c if c.isprintable() or c == "\n" else f"\\u{ord(c):04x}" for c in text[:MAX_FAULT])


def innermost(error: BaseException) -> BaseException:
    """The first cause of an error, which xacro wraps."""
    for _ in range(MAX_CAUSES):
        cause = getattr(error, "exc", None) or error.__cause__
        if cause is None:
            break
        error = cause
    return error


def message_of(error: BaseException) -> str:
    """Message of the innermost cause, and what xacro's errors around it add without repeating it."""
    first = innermost(error)
    said = [str(first).strip() or type(first).__name__]
    while error is not first:
        own = Exception.__str__(error).strip() if isinstance(error, Exception) else ""
        texts = (own, str(getattr(error, "suffix", None) or "").strip())
        said += [text for text in texts if text and text != "None" and said[0] not in text]
        error = getattr(error, "exc", None) or error.__cause__ or first
    return "; ".join(dict.fromkeys(said))


def main() -> None:
    """Expand the file that the task on standard input names, and write the answer as JSON."""
    task = json.load(sys.stdin)
    out, sys.stdout = sys.stdout, sys.stderr  # What xacro prints is no answer.
    try:
        answer = {"text": expanded(task["file"], task["folders"], task["packages"], task["arguments"])}
    except ImportError:
        answer = {"absent": "xacro"}
    except BaseException as error:  # Also what is no Exception: the parent says it, whatever it is.
        answer = {"fault": printable(message_of(error)), "package": printable(getattr(innermost(error), "package", ""))}
    out.write(json.dumps(answer))


if __name__ == "__main__":
    main()
