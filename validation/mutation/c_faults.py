"""Faults that can be planted in C, by its tokens: comments, strings and lines of the preprocessor are left out.

So is what is compiled on another system only.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from .fault import COMPARISON, CONSTANT, DROPPED, INDEX, OPERATOR, SIGN, SWAPPED, SourceFault

_TOKEN = re.compile(
    r"""(?P<skip>^\#if[^\n]*_WIN32.*?^\#(?:else|endif)[^\n]*|\s+|/\*.*?\*/|//[^\n]*
        |^[ \t]*\#(?:[^\n\\]|\\.|\\\n)*|"(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')
    |(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[fuUlL]*|0[xX][0-9a-fA-F]+[uUlL]*)
    |(?P<name>[A-Za-z_]\w*)
    |(?P<symbol><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
_COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&"}
_OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
_TYPES = {"double", "float", "int", "char", "void", "const", "static", "unsigned", "size_t", "struct", "enum", "inline"}
_NO_CALL = {"if", "for", "while", "switch", "return", "sizeof", "defined", "memset"}
_CALLED = {"sin": "cos", "cos": "sin", "fmin": "fmax", "fmax": "fmin", "fabs": "", "floor": "ceil", "ceil": "floor"}


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)

    @property
    def is_type(self) -> bool:
        return self.text in _TYPES or bool(re.fullmatch(r"u?int\d+_t|\w+_t|[A-Z]\w*_T", self.text))


def c_faults(module: str, text: str) -> list[SourceFault]:
    """Every fault that can be planted in a file of C."""
    return list(dict.fromkeys(_Planter(module, text).faults()))


class _Planter:
    def __init__(self, module: str, text: str) -> None:
        self.module, self.text = module, text
        self.tokens = [
            _Token(str(match.lastgroup), match[0], match.start())
            for match in _TOKEN.finditer(text)
            if match.lastgroup != "skip"
        ]

    def _replaced(self, kind: str, start: int, end: int, after: str) -> SourceFault:
        line = self.text.count("\n", 0, start) + 1
        return SourceFault(self.module, line, kind, start, self.text[start:end], after)

    def faults(self) -> Iterator[SourceFault]:
        depth = 0  # Of braces: outside of functions nothing computes.
        brackets = 0
        for i, token in enumerate(self.tokens[1:-1], 1):
            if token.text in "{}":
                depth += 1 if token.text == "{" else -1
            brackets += {"[": 1, "]": -1}.get(token.text, 0)
            if depth:
                before, after = self.tokens[i - 1], self.tokens[i + 1]
                if token.kind == "symbol":
                    yield from self._symbol(i, before, token, after)
                elif token.kind == "number":
                    yield from self._number(token, brackets > 0, before)
                elif after.text == "(" and not token.is_type and token.text not in _NO_CALL:
                    yield from self._call(i, before, token)

    def _symbol(self, i: int, before: _Token, token: _Token, after: _Token) -> Iterator[SourceFault]:
        operator = token.text
        is_operand = before.kind in ("number", "name") or before.text in ")]"
        binary = is_operand and before.text not in ("return", "case") and not before.is_type
        if operator == "*" and (self.text[token.start - 1] != " " or self.text[token.end] != " "):
            return  # Of a pointer.
        if operator in _COMPARISONS and binary:
            yield self._replaced(COMPARISON, token.start, token.end, _COMPARISONS[operator])
        elif operator in _OPERATORS and binary:
            yield self._replaced(OPERATOR, token.start, token.end, _OPERATORS[operator])
            if operator in "+-":
                end = self._product_end(i + 1)
                if end is not None:
                    yield self._replaced(DROPPED, token.start, end, "")
        elif operator == "-" and not is_operand and after.kind == "name":
            yield self._replaced(SIGN, token.start, token.end, "")

    def _product_end(self, i: int) -> int | None:
        """Offset where the product that begins at a token ends."""
        while True:
            end = self._primary_end(i)
            if end is None or end >= len(self.tokens):
                return None
            if self.tokens[end].text not in "*/%":
                return self.tokens[end - 1].end
            i = end + 1

    def _primary_end(self, i: int) -> int | None:
        """Index of the token after an operand: a number, a name with members, indices, arguments; or parentheses."""
        while self.tokens[i].text in "-*&!":
            i += 1
        if self.tokens[i].kind == "symbol" and self.tokens[i].text != "(":
            return None
        i = self._closed(i) + 1 if self.tokens[i].text == "(" else i + 1
        while i < len(self.tokens):
            if self.tokens[i].text in "([":
                i = self._closed(i) + 1
            elif self.tokens[i].text in (".", "->"):
                i += 2
            else:
                break
        return i

    def _closed(self, i: int) -> int:
        """Index of the bracket that closes the one at index i; the last token if none does."""
        depth = 0
        for k in range(i, len(self.tokens)):
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(self.tokens[k].text, 0)
            if depth == 0:
                return k
        return len(self.tokens) - 1

    def _number(self, token: _Token, index: bool, before: _Token) -> Iterator[SourceFault]:
        if before.text in ("{", "case"):
            return
        if token.text.isdecimal():
            number = int(token.text)
            wrong = number - 1 if index and number > 0 else number + 1
            yield self._replaced(INDEX if index else CONSTANT, token.start, token.end, str(wrong))
        elif re.fullmatch(r"[\d.]+(?:e[-+]?\d+)?[fFlL]?", token.text):
            digits = token.text.rstrip("fFlL")
            wrong_number = repr(2.0 * float(digits) or 1.0)
            yield self._replaced(CONSTANT, token.start, token.end, wrong_number + token.text[len(digits) :])

    def _call(self, i: int, before: _Token, token: _Token) -> Iterator[SourceFault]:
        close = self._closed(i + 1)
        following = self.tokens[close + 1].text if close + 1 < len(self.tokens) else ""
        if before.is_type or following == "{":
            return
        if token.text in _CALLED:
            yield self._replaced(OPERATOR, token.start, token.end, _CALLED[token.text])
        if before.text in (";", "{", "}", ")") and following == ";":
            yield self._replaced(DROPPED, token.start, self.tokens[close].end, "(void)0")
        ends = self._argument_ends(i + 1, close)
        if len(ends) >= 2:
            first = self.text[self.tokens[i + 2].start : ends[0].start]
            gap = self.text[ends[0].end : self.tokens[self.tokens.index(ends[0]) + 1].start]
            second_start = ends[0].end + len(gap)
            second = self.text[second_start : ends[1].start]
            if first != second:
                yield self._replaced(SWAPPED, self.tokens[i + 2].start, ends[1].start, f"{second},{gap}{first}")

    def _argument_ends(self, opening: int, close: int) -> list[_Token]:
        """The commas between a call's arguments, and its closing bracket; none for a call without arguments."""
        ends, depth = [], 0
        for k in range(opening + 1, close):
            depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(self.tokens[k].text, 0)
            if depth == 0 and self.tokens[k].text == ",":
                ends.append(self.tokens[k])
        return [*ends, self.tokens[close]] if close > opening + 1 else []
