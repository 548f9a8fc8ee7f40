"""XML -> elements in which each knows its line; document types, and with them entities, are refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from symofros.errors import DescriptionError

MAX_DEPTH = 100
MAX_TEXT = 4096


@dataclass(slots=True)
class Element:
    """One element.

    Attributes:
        tag: Name of the element, as written.
        attributes: Name -> text.
        line: Line of the start tag, counted from 1.
        children: Child elements in order.
        file: Name of the file.
        text: Text before its end, of all pieces between its children, without white space around it.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    file: str = ""
    text: str = ""

    @property
    def where(self) -> str:
        """Place of the element in the file, as "file:line"."""
        return f"{self.file}:{self.line}"

    def all(self, tag: str) -> Iterator[Element]:
        """The children of that name."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """The first child of that name."""
        return next(self.all(tag), None)


def parse_xml(data: bytes, file: str) -> Element:
    """Read an XML document.

    Args:
        data: The file's content.
        file: File name, for the problem.

    Raises:
        DescriptionError: Not well-formed, too deep, or with a document type (the only way to define entities).
    """
    builder = _Builder(file)
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        syntax_error = f"{expat.ErrorString(error.code)}, column {error.offset + 1}"
        if builder.open:
            syntax_error += f"; <{builder.open[-1].tag:.60}> of line {builder.open[-1].line} is not closed"
        raise DescriptionError(
            "the text is not well-formed XML",
            syntax_error,
            "a robot file is one XML document",
            "mind unclosed elements and quotes near this line",
            f"{file}:{error.lineno}",
        ) from None
    except (LookupError, ValueError) as error:
        raise DescriptionError(
            "the text's encoding is unknown",
            str(error),
            "the encoding is one that Python knows",
            "save the file as UTF-8",
            f"{file}:1",
        ) from None
    assert builder.root is not None  # Expat has found the document well-formed.
    return builder.root


class _Builder:
    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Element | None = None
        self.open: list[Element] = []
        self.parser = expat.ParserCreate()
        self.parser.StartDoctypeDeclHandler = self.doctype
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.characters
        self.parser.buffer_text = True

    def fault(self, what: str, found: str, rule: str, remedy: str) -> DescriptionError:
        return DescriptionError(what, found, rule, remedy, f"{self.file}:{self.parser.CurrentLineNumber}")

    def doctype(self, name: str, *_: object) -> None:
        raise self.fault(
            "document types are refused",
            f"<!DOCTYPE {name:.60}",
            "a robot file defines no entities",
            "remove the declaration",
        )

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self.open) >= MAX_DEPTH:
            raise self.fault(
                f"nested deeper than {MAX_DEPTH}",
                f"<{tag}>",
                "a robot file needs fewer than ten",
                "check that it is the file you meant",
            )
        element = Element(tag, attributes, self.parser.CurrentLineNumber, file=self.file)
        if self.open:
            self.open[-1].children.append(element)
        else:
            self.root = element
        self.open.append(element)

    def characters(self, text: str) -> None:
        # A <pose> is some hundred characters long; long texts belong to plugins, and nobody reads them.
        if self.open and len(self.open[-1].text) < MAX_TEXT:
            self.open[-1].text += text[:MAX_TEXT]

    def end(self, tag: str) -> None:
        element = self.open.pop()
        element.text = element.text.strip()
