"""The contract of an engine's plug-in: what is asked of it, and what it says of itself.

An engine is asked in its own conventions, about trees of rigid links that are stated neutrally (`Tree`). It says how it
keeps a tree's joints (`Slot`: a chart of `charts.CHARTS`, and where coordinates and speeds stand in its q and v); the
truth is then worked out in the same coordinates and speeds. A plug-in is an object with the members of `EnginePlugin`,
offered under the entry-point group `symofros.engines`:

    [project.entry-points."symofros.engines"]
    mine = "my_package.plugin:PLUGIN"
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from typing import Literal, NamedTuple, Protocol

from ..contract.interface import Unsupported as Unsupported
from ..contract.raised import Raised, attempted
from .frames import IDENTITY as IDENTITY
from .frames import ORIGIN as ORIGIN
from .frames import Array as Array
from .frames import End as End
from .frames import Rows as Rows
from .frames import Vector as Vector
from .frames import rows as rows
from .frames import vector as vector
from .lines import Activation as Activation
from .lines import Actuator as Actuator
from .lines import Medium as Medium
from .lines import Muscle as Muscle
from .lines import Tendon as Tendon
from .lines import Wrap as Wrap
from .tree import Constraint as Constraint
from .tree import Joint as Joint
from .tree import Link as Link
from .tree import Tree as Tree

GROUP = "symofros.engines"
# Length of the one step that integrators are asked for [s].
STEP = 0.015625


class Steps(NamedTuple):
    """A function that an engine documents to take by differences of finite steps.

    Attributes:
        function: Name of the function that it takes differences of.
        step: Size of a step.
        truncation: What the steps' size makes of a smooth function, as part of the largest entry.
    """

    function: str
    step: float
    truncation: float


class Convention(NamedTuple):
    """One convention of an engine that a reader must know; where it differs from ours, `contract.conventions` says."""

    what: str
    convention: str


class Statement(NamedTuple):
    """What an engine says of itself that explains an answer that is not right; one that is right, it never hides.

    Attributes:
        verdict: "precondition": it documents or asserts that it is not for this. "repairs": it changed what it was
            given, with a warning.
        words: What it says.
        source: Where: a link, or a file and line of a release.
        functions: Pattern of whole names of functions that it is about.
        holds: Tree, text of the file that it was read from ("" for none) -> whether it is about that.
        warned: Pattern of a warning of Python's that the engine gave as the model was made; "" for none.
    """

    verdict: Literal["precondition", "repairs"]
    words: str
    source: str
    functions: str = ".*"
    holds: Callable[[Tree, str], bool] = lambda tree, text: True
    warned: str = ""


# Unit roundoffs (the spacing of numbers at 1), and the random states that a function is asked at unless said otherwise.
DOUBLE, SINGLE = 2.0**-52, 2.0**-23
CALLS = 16


# The name in plug-ins that were written before `contract.conventions.Difference` was distinguished from it.
Difference = Convention


@dataclass(frozen=True)
class Slot:
    """How an engine keeps one joint.

    Attributes:
        chart: Key of `charts.CHARTS`: what its coordinates and speeds mean.
        q: Places (nq of the chart) in the engine's q.
        v: Places (nv of the chart) in the engine's v. A joint that mimics another names the other's places.
    """

    chart: str
    q: tuple[int, ...]
    v: tuple[int, ...]


@dataclass(frozen=True)
class State:
    """What a function is evaluated at, in the engine's own coordinates and speeds.

    Attributes:
        q: Coordinates (nq).
        v: Speeds (nv).
        a: Rates of the speeds (nv).
        tau: Forces (nv), of the powers tau^T v.
        v2: Further speeds (nv): a displacement to integrate by.
        q2: Further coordinates (nq): those to take a difference to.
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    v2: Array
    q2: Array


class HasLayout(Protocol):
    """Layout of the coordinates q and speeds v in which an engine keeps the joints of a tree."""

    @property
    def nq(self) -> int:
        """Length of its q."""

    @property
    def nv(self) -> int:
        """Length of its v."""

    @property
    def slots(self) -> tuple[tuple[Slot, ...], ...]:
        """Slots of the joints of each link of the tree, in its order, without fixed and locked ones."""


class EngineModel(HasLayout, Protocol):
    """One tree in one engine."""

    def call(self, function: str, state: State) -> Array | Unsupported:
        """A function of the plug-in's `functions`, by name, in the conventions stated there for its result.

        What is linear in speeds is so in the engine's own; derivatives are along its own speeds: the k-th column is
        the rate along q' = N(q) e_k. Bodies are the tree's links in their order.
        """

    def script(self, function: str, state: State) -> str:
        """Python that imports the engine and NumPy only, and leaves the call's result in `value`; "" for none."""


class EnginePlugin(Protocol):
    """One engine.

    Attributes:
        name: Name in tables.
        package: Name of its distribution, for its version.
        extra: What to install: `pip install EXTRA`.
        conventions: What a reader must know of its conventions.
        kinds: Names of `kinds.KINDS` that it has of its own -> what it calls them.
        functions: Names of `functions.FUNCTIONS` that it offers -> what it calls them. A second way to the same is
            named after a colon: "inverse_dynamics:mj_rne".
        gravity: The one acceleration of gravity (3) that it knows; () where a tree may state any.
        formats: Formats of files that its own parser reads, of "urdf", "mjcf", "sdf", "usd" (`readers.Reading`).
        slacks: Functions that it documents as approximate -> error to grant, as part of the largest entry, or the steps
            of its differences.

    A plug-in may have more: `demands`, `refusals`, `statements`, `roundoff` and `calls` of
    `plugins.writing.source.SourcePlugin`.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def package(self) -> str: ...  # noqa: D102
    @property
    def extra(self) -> str: ...  # noqa: D102
    @property
    def conventions(self) -> tuple[Convention, ...]: ...  # noqa: D102
    @property
    def kinds(self) -> Mapping[str, str]: ...  # noqa: D102
    @property
    def functions(self) -> Mapping[str, str]: ...  # noqa: D102
    @property
    def gravity(self) -> tuple[float, ...]: ...  # noqa: D102
    @property
    def formats(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def slacks(self) -> Mapping[str, float | Steps]: ...  # noqa: D102

    def version(self) -> str:
        """Version of the engine; "" where it is not installed."""

    def build(self, tree: Tree) -> EngineModel | Unsupported:
        """The tree by the engine's API."""

    def read(self, tree: Tree, form: str, text: str) -> EngineModel | Unsupported:
        """A file by the engine's own parser; its `text` states the tree, with joints and links of the links' names."""


# What a plug-in has.
_MEMBERS = tuple("name package extra conventions kinds functions gravity formats slacks version build read".split())


@dataclass
class Registry:
    """The plug-ins of this installation.

    Attributes:
        plugins: Name -> plug-in.
        failures: Entry points that did not load, or not what the contract asks for -> why.
    """

    plugins: dict[str, EnginePlugin] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)


def installed(own: Mapping[str, EnginePlugin], functions: Collection[str] = ()) -> Registry:
    """Our plug-ins and those of other packages; of these, what breaks the contract at first sight is a failure.

    Args:
        own: Plug-ins that come with this package.
        functions: Names of the functions that can be offered; none: any.
    """
    registry = Registry(dict(own))
    for point in entry_points(group=GROUP):
        plugin = attempted(point.load)
        if isinstance(plugin, Raised):
            registry.failures[point.name] = plugin.words
        elif fault := _fault(plugin, point.name, functions):
            registry.failures[point.name] = fault
        else:
            registry.plugins[point.name] = plugin
    return registry


def _fault(plugin: EnginePlugin, name: str, functions: Collection[str]) -> str:
    """What makes a stranger's plug-in of no use; "" for nothing."""

    def stated() -> str:
        missing = [member for member in _MEMBERS if not hasattr(plugin, member)]
        if missing:
            return f"no {', '.join(missing)}: a plug-in has the members of EnginePlugin"
        if plugin.name != name:
            return f"its name is '{plugin.name}', that of its entry point '{name}': they must be the same"
        if any(len(row) != 2 for row in plugin.conventions) or len(plugin.gravity) not in (0, 3):
            return "conventions are pairs of what and convention, gravity is three numbers or none"
        dict(plugin.kinds), dict(plugin.slacks), plugin.version()
        unknown = [one for one in plugin.functions if functions and one.partition(":")[0] not in functions]
        return f"no functions {', '.join(unknown)}: those that can be offered are in functions" if unknown else ""

    said = attempted(stated)
    return said.words if isinstance(said, Raised) else said
