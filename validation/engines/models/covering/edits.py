"""Files with one feature of a format and with two: edits of a plain file, whose meaning is read off what results.

A table has factors, each with the features that exclude each other: a feature is some edits of the plain file. Each
feature alone makes a file, which bears its name, and so do pairs of two factors that are drawn at random.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product
from xml.etree import ElementTree as XML

from ...interface import Tree
from ..files.readers import Reading, shown
from .pairs import Pair

# Of an element at a path: attributes to state (None: to leave out); "-" drops it, "+..." puts elements last in it,
# "<..." first, "=..." in its place, "^..." an element around it;
# "~" turns the order of what it holds.
Edit = tuple[str, Mapping[str, str | None] | str]
Feature = Sequence[Edit]
# Factor -> feature -> its edits.
Features = Mapping[str, Mapping[str, Feature]]
BETWEEN = " + "
_SEED = 30


def parts(name: str) -> tuple[str, ...]:
    """The name of a file, and where it has two features, those of the files that have one of them."""
    form, _, stated = name.partition(": ")
    if BETWEEN not in stated:
        return (name,)
    written = ", written" if stated.endswith(", written") else ""
    return (name, *(f"{form}: {one}{written}" for one in stated.removesuffix(written).split(BETWEEN)))


def edited(text: str, edits: Feature) -> str:
    """A document of XML after edits, one after the other.

    Raises:
        LookupError: A path leads to no element.
    """
    root = XML.fromstring(text)
    for path, what in edits:
        found = [root] if path == "." else root.findall(path)
        if not found:
            raise LookupError(f"no element at {path}")
        above = {child: parent for parent in root.iter() for child in parent}
        for element in found:
            _edit(element, above.get(element, root), what)
    return XML.tostring(root, encoding="unicode")


def _edit(element: XML.Element, parent: XML.Element, what: Mapping[str, str | None] | str) -> None:
    if not isinstance(what, str):
        for name, value in what.items():
            element.attrib.pop(name, None)
            if value is not None:
                element.set(name, value)
        return
    how, place = what[0], list(parent).index(element) if element in parent else 0
    own = list(XML.fromstring(f"<all>{what.removeprefix(how) if how != '<' else what}</all>"))
    match how:
        case "+":
            element.extend(own)
        case "<":
            element[:0] = own
        case "~":
            element[:] = reversed(element)
        case "^":
            innermost = parent[place] = own[0]
            while len(innermost):
                innermost = innermost[0]
            innermost.append(element)
        case _:
            parent[place : place + 1] = own


def with_features(
    form: str,
    plain: str,
    features: Features,
    meaning: Callable[[str], Tree],
    pairs: int,
    never: Collection[Pair] = (),
    edit: Callable[[str, Feature], str] = edited,
) -> dict[str, Reading]:
    """The plain file, one for each feature, and as many of two features, by name.

    Args:
        form: Format.
        plain: The plain file.
        features: Table of the features.
        meaning: Text -> the tree that it states, by the format's own pages.
        pairs: Number of pairs of features.
        never: Pairs of features, or of a feature and a factor, that no file has, as the format leaves them open.
        edit: Text, feature -> text.
    """
    every = {name: feature for named in features.values() for name, feature in named.items()}
    owner = {name: factor for factor, named in features.items() for name in named}

    def is_open(one: str, other: str) -> bool:
        sides = (one, owner[one]), (other, owner[other])
        return owner[one] == owner[other] or any(frozenset(pair) in never for pair in product(*sides))

    possible = [pair for pair in combinations(every, 2) if not is_open(*pair)]
    drawn = random.Random(_SEED).sample(possible, min(pairs, len(possible)))
    chosen = [("plain",), *((name,) for name in every), *drawn]
    made = {}
    for names in chosen:
        text = edit(plain, [one for name in names for one in every.get(name, ())])
        title = f"{form}: {BETWEEN.join(names)}"
        tree = replace(meaning(text), name=title)
        made[title] = Reading(form, text, tree, shown(tree))
    return made
