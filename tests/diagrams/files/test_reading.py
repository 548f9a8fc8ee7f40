"""Diagram files in: what they state, and every fault of theirs with its line, before anything runs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

import symofros as sf
from symofros.blocks import UdpTransmitter
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.files.fields import types_of, words_for
from symofros.diagrams.files.registry import kind_of, kinds
from symofros.diagrams.files.schema import of_type
from tests.diagrams.files.cases import TEXT, folder_with, line_of


@dataclass(frozen=True, kw_only=True)
class UnitGain(Block):
    """Multiplies; its ports have units."""

    gain: Any = 1.0
    takes: str = ""

    def ports(self, environment: Environment) -> Ports:
        shape = environment.inputs.get("u")
        return Ports((Port("u", shape, self.takes),), (Port("y", shape),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.numbers(self.gain) * context.inputs["u"]}


FAULTS = YAML(typ="safe").load(Path(__file__).with_name("faults.yaml"))


def problems(path: Path, text: str, **options: object) -> list[sf.Problem]:
    """What loading, or else reading as a whole, finds."""
    with pytest.raises(sf.DescriptionError) as caught:
        sf.Simulation(sf.load_diagram(folder_with(path, text), **options))
    return list(caught.value.problems)


def test_a_diagram_file_is_read_completely(tmp_path: Path) -> None:
    d = sf.load_diagram(folder_with(tmp_path))
    assert d.name == "held_arm" and list(d.blocks) == ["plant", "pd"] and d.simulation.t_end == 0.2
    assert [plot.signals for plot in d.simulation.plots] == [("plant.q",), ("pd.effort[0]",), ("plant.v",)]
    run = sf.Simulation(d).run()
    assert run.outcome.ok and run.t[-1] == 0.2 and len(run.t) == 21
    assert np.allclose([run["plant.q"][0], run["plant.v"][0]], [[0.5, 0.0], [0.0, 0.1]])


@pytest.mark.parametrize(("old", "new", "line", "words"), FAULTS)
def test_faults_name_their_place_in_the_file(tmp_path: Path, old: str, new: str, line: str, words: list[str]) -> None:
    assert old in TEXT
    text = TEXT.replace(old, new.replace("LONG", 500 * "a"), 1)
    found = problems(tmp_path, text)
    first = "\n".join(map(str, found))
    assert all(word in first for word in words), first
    assert any(one.where.endswith(f":{line_of(text, line)}") for one in found), (first, line_of(text, line))


def test_all_faults_of_a_diagram_are_reported_together(tmp_path: Path) -> None:
    text = TEXT.replace("kd: 2", "kd: [{}]").replace("t_end: 0.2", "t_end: x")
    text = text.replace("kind: forward_d", "kind: froward_d")
    found = problems(tmp_path, text.replace("m2: 0.9", "m2: a"))
    assert [one.where.rpartition(":")[2] for one in found] == ["4", "6", "15", "21"]
    loose = TEXT.replace("      q: plant.q\n", "").replace("      v: plant.v\n", "")
    assert len(problems(tmp_path, loose)) == 2


def test_shapes_and_units_must_fit(tmp_path: Path) -> None:
    gain = "  g: {kind: unit_gain, takes: N m, inputs: {u: plant.q}}\noutlets:"
    text = TEXT.replace("outlets:", gain)
    (one,) = problems(tmp_path, text, blocks=[UnitGain])
    assert "plant.q -> g.u: units differ" in one.what and one.found == "rad" and "N m" in one.rule
    assert one.where.endswith(f":{line_of(text, 'unit_gain')}")
    (one,) = problems(tmp_path, text.replace("takes: N m", "gain: [1, 2, 3]"), blocks=[UnitGain])
    assert "block 'g': its fields do not fit its inputs" in one.what and "u (2,)" in one.rule
    scope = "  s: {kind: udp_receiver, port: 9, size: 3}\noutlets:"
    text = TEXT.replace("outlets:", scope).replace("{u: pd.effort}", "{u: s.signal}")
    (one,) = problems(tmp_path, text)
    assert "s.signal -> plant.u: shapes differ" in one.what and one.found == "(3,)" and "(2,)" in one.rule
    assert one.where.endswith(f":{line_of(text, 's.signal')}")


@dataclass(frozen=True, kw_only=True)
class FromFile(Block):
    """Reads a file when it is made."""

    file: str = ""
    units: Any = None

    def __post_init__(self) -> None:
        Path(self.file).read_text()


def test_files_of_blocks_are_relative_to_the_diagram(tmp_path: Path) -> None:
    text = TEXT.replace("outlets:", "  f: {kind: from_file, file: data/x.csv, units: {y: [N m, s]}}\noutlets:")
    (found,) = problems(tmp_path, text, blocks=[FromFile])
    assert "'data/x.csv' does not exist" in found.what and found.where.endswith(f":{line_of(text, 'from_file')}")
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "x.csv").write_text("t,y\n")
    d = sf.load_diagram(folder_with(tmp_path, text), blocks=[FromFile])
    assert d.blocks["f"] == FromFile(name="f", file=str(tmp_path / "data" / "x.csv"), units={"y": ("N m", "s")})
    sf.save_diagram(d, tmp_path / "again.yaml")
    assert "file: data/x.csv" in (tmp_path / "again.yaml").read_text()
    assert sf.load_diagram(tmp_path / "again.yaml", blocks=[FromFile]).blocks == d.blocks
    for outside in ("/etc/hostname", "../x.csv", "data/../../x.csv"):
        (found,) = problems(tmp_path, text.replace("data/x.csv", outside), blocks=[FromFile])
        assert "leaves the diagram's folder" in found.what
    (tmp_path / "other").mkdir()
    with pytest.raises(sf.DescriptionError, match="outside the diagram's folder"):
        sf.save_diagram(d, tmp_path / "other" / "again.yaml")
    assert not list((tmp_path / "other").iterdir())


PART = """\
symofros_diagram: 1
models: {own: {file: arm.yaml}}
blocks:
  pd: {kind: joint_pd, kp: 5, kd: 1, period: 0.01}
  ff: {kind: inverse_dynamics, model: own, inputs: {a: hold.y, v: hold.y}}
  hold: {kind: unit_gain}
inlets: {q: [pd.q, pd.q_desired, ff.q], v: [pd.v, hold.u]}
outlets: {effort: pd.effort}
"""


def test_parts_are_read_from_files(tmp_path: Path) -> None:
    (tmp_path / "part.yaml").write_text(PART)
    text = TEXT[: TEXT.index("  pd:")].replace("pd.effort[0]", "left.effort[0]").replace("pd.effort", "left.effort")
    text += "parts:\n  left:\n    file: part.yaml\n    models: {own: arm}\n    inputs: {q: plant.q, v: plant.v}\n"
    d = sf.load_diagram(folder_with(tmp_path, text), blocks=[UnitGain])
    assert list(d.models) == ["arm"] and d.blocks["left/ff"].model == "arm"  # type: ignore[attr-defined]
    assert sf.Simulation(d).run(0.05).outcome.ok
    (one,) = problems(tmp_path, text.replace("{q: plant.q, v", "{p: plant.q, v"), blocks=[UnitGain])
    assert "no inlet 'p'" in one.what and one.where.endswith(f":{line_of(text, 'file: part')}")
    found = problems(tmp_path, text.replace("{q: plant.q, v", "{q: plant.q, models: plant.q, v"), blocks=[UnitGain])
    assert any("no inlet can be called 'models'" in one.what for one in found)
    (tmp_path / "part.yaml").write_text(PART.replace("kp: 5", "kp: [{}]"))
    (one,) = (one for one in problems(tmp_path, text, blocks=[UnitGain]) if "kp" in one.what)
    assert one.where.endswith("part.yaml:4")


def test_parts_that_contain_themselves_are_refused(tmp_path: Path) -> None:
    text = TEXT + "parts:\n  again: {file: diagram.yaml}\n"
    (one,) = problems(tmp_path, text)
    assert "closes a cycle" in one.what and one.found == "diagram.yaml -> diagram.yaml"


def test_parts_that_multiply_are_bounded(tmp_path: Path) -> None:
    for i in range(8):
        parts = "\n".join(f"  p{k}: {{file: part{i + 1}.yaml}}" for k in range(8))
        (tmp_path / f"part{i}.yaml").write_text(f"symofros_diagram: 1\nparts:\n{parts}\n")
    (tmp_path / "part8.yaml").write_text("symofros_diagram: 1\nblocks: {s: {kind: scope, signals: [x]}}\n")
    with pytest.raises(sf.DescriptionError, match="at most 10 levels and 100 files"):
        sf.load_diagram(tmp_path / "part0.yaml")


def test_network_addresses_need_an_explicit_option(tmp_path: Path) -> None:
    text = TEXT.replace(
        "outlets:",
        "  tx: {kind: udp_transmitter, host: 192.0.2.1, port: 9, period: 0.1, inputs: {signal: plant.q}}\noutlets:",
    )
    (one,) = problems(tmp_path, text)
    assert "reaches another machine" in one.what and one.found == "192.0.2.1:9"
    assert isinstance(sf.load_diagram(folder_with(tmp_path, text), network=True).blocks["tx"], UdpTransmitter)


@dataclass(frozen=True, kw_only=True)
class Named(Block):
    """Its fields bear the names of entries that every block has."""

    kind: str
    inputs: tuple[str, ...] = ()


def test_fields_named_like_entries_get_an_underscore(tmp_path: Path) -> None:
    text = TEXT.replace("outlets:", "  n: {kind: named, kind_: odd, inputs_: [a, b]}\noutlets:")
    d = sf.load_diagram(folder_with(tmp_path, text), blocks=[Named])
    assert d.blocks["n"] == Named(name="n", kind="odd", inputs=("a", "b"))
    sf.save_diagram(d, tmp_path / "again.yaml")
    assert sf.load_diagram(tmp_path / "again.yaml", blocks=[Named]) == d


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_fields_of_every_kind_have_supported_types(kind: str) -> None:
    owner = kinds()[kind]
    assert kind == kind_of(owner)
    for name, of in types_of(owner).items():
        assert words_for(of) and of_type(of), name


def test_hostile_bytes_are_refused(tmp_path: Path, rng: np.random.Generator) -> None:
    data = TEXT.encode()
    for _ in range(60):
        spoilt = bytearray(data)
        for at in rng.integers(0, len(data), 3):
            spoilt[at] = rng.integers(1, 255)
        file = folder_with(tmp_path)
        file.write_bytes(bytes(spoilt))
        try:
            sf.Simulation(sf.load_diagram(file))
        except sf.SymofrosError:
            continue
