import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from tests.validation.subjects import pendulum
from validation.checking import ModelResult, Settings, check, failed
from validation.comparison.errors import Comparison
from validation.contract.interface import Subject
from validation.cross_check.record import Record, as_data
from validation.cross_check.report import TOPIC, compose
from validation.reporting import html, markdown
from validation.reporting.command import code, write
from validation.reporting.provenance import Provenance
from validation.reporting.record import Data
from validation.reporting.terminal import show

SETTINGS = Settings(states=20)
NASTY = "<script>alert(1)</script>|x"


@pytest.fixture(scope="module")
def good() -> ModelResult:
    return check(Subject("pendulum", pendulum(notes=("shapes ignored",))), SETTINGS)


@pytest.fixture(scope="module")
def mixed(good: ModelResult) -> Data:
    wrong = Comparison(NASTY, "mujoco", "bias", "disagree", 20, 3e-7, 1e-12, 1e-7, 4, (0,) * 40 + (20,) + (0,) * 33)
    nan = Comparison(NASTY, "mujoco", "mass_matrix", "disagree", 20, None, 1e-12, None, 0, (0,) * 73 + (20,))
    cannot = Comparison(NASTY, "mujoco-urdf", "all", "unsupported", note="body 'a': it | can't")
    models = [good, ModelResult(NASTY, (wrong, nan, cannot)), failed("gone", "load", "no such file")]
    return as_data(SETTINGS, models, 3.0, ())


def test_an_infinite_error_fails_and_is_reported() -> None:
    """As of a note that is absent: JSON has no infinite numbers."""
    absent = Comparison("pendulum", "formulas", "notes", "disagree", 1, float("inf"), 6e-3, note="none says so")
    data = json.loads(json.dumps(as_data(SETTINGS, [ModelResult("pendulum", (absent,))], 3.0, ()), allow_nan=False))
    assert not data["ok"] and "none says so" in to_markdown(data)


def to_html(data: Data) -> str:
    return html.page(compose(data), Provenance.of(data))


def to_markdown(data: Data) -> str:
    return markdown.page(compose(data), Provenance.of(data), "")


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.add(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href")]
        if tag not in ("meta", "link", "br", "img", "circle", "line", "path", "polygon", "polyline", "rect"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.open and self.open[-1] == tag:
            self.open.pop()


def test_the_page_needs_nothing_from_outside(mixed: Data) -> None:
    page = to_html(mixed)
    tags = Tags()
    tags.feed(page)
    assert (
        not tags.open and all(link.startswith("#") for link in tags.links) and not tags.seen & {"script", "link", "img"}
    )
    assert not re.search(r"url\((?!#)", page) and "@import" not in page
    assert re.findall(r'https?://[^"\s<]+', page.replace("http://www.w3.org/2000/svg", "")) == []


def test_long_sections_are_folded_and_what_disagrees_is_not(mixed: Data) -> None:
    written = html.page(compose(mixed))
    assert "<h2>What disagrees or failed</h2>" in written
    assert all(f'<div id="{name}">' in written for name in ("models", "gaps", "method", "each"))


def test_names_from_files_cannot_break_the_page(mixed: Data) -> None:
    assert NASTY not in to_html(mixed) and "&lt;script&gt;" in to_html(mixed)
    for block in to_markdown(mixed).split("\n\n"):
        columns = {len(re.findall(r"(?<!\\)\|", row)) for row in block.splitlines() if row.startswith("|")}
        assert len(columns) <= 1, block


def test_comparisons_with_independent_engines_are_counted_separately(mixed: Data) -> None:
    """Our own code, read by other compilers or by NumPy, and formulas of ours are no second opinion."""
    own = {"vectors", "interpreted", "description", "formulas", "relations", "symofros"}
    judged = [row for row in mixed["comparisons"] if row["tolerance"]]
    independent = [row for row in judged if row["engine"] not in own]
    assert 0 < len(independent) < len(judged)
    assert mixed["independent"] == len(independent) == Record.of(mixed).independent
    said = f"{len(independent)} of the comparisons are with independent engines."
    report = compose(mixed)
    assert report.summary.endswith(said) and said in to_html(mixed)
    facts = {fact.label: fact.value for fact in report.facts}
    label = f"comparisons with independent engines; {len(judged) - len(independent)} with our own code and formulas"
    assert facts[label] == str(len(independent))


def test_disagreements_are_shown_in_all_formats(mixed: Data) -> None:
    assert not mixed["ok"] and code(compose(mixed)) == 1
    for text in (to_html(mixed), to_markdown(mixed)):
        assert "What disagrees or failed" in text and "bias: error 3.0e-07 in state 4 of 20" in text
        assert "no such file" in text and "not a number" in text and "1 model failed" in text
        # Of three models one could not be read: nothing was compared on it.
        assert "on 2 models disagree, 1 model failed" in text


def test_an_empty_check_is_not_ok() -> None:
    record = as_data(SETTINGS, [], 0.0, ())
    assert not record["ok"]
    assert "Nothing was compared" in to_html(record) and "Nothing was compared" in to_markdown(record)


def test_json_is_strict_and_complete(mixed: Data) -> None:
    content = json.loads(json.dumps(mixed), parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert content["ok"] is False and set(TOPIC.printed) < set(content)
    assert {model["model"] for model in content["models"]} == {"pendulum", NASTY, "gone"}
    assert content["settings"]["states"] == 20 and "numpy" in content["versions"] and content["machine"]["processor"]
    first = content["models"][0]
    assert re.fullmatch(r"[0-9a-f]{16}", first["hash"]) and first["nv"] == 1


def test_files_are_whole_and_tell_no_paths(mixed: Data, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "reports"
    write(TOPIC, mixed, folder)
    written = sorted(path.name for path in folder.iterdir())
    assert written == ["check.html", "check.json", "check.md"]
    for path in folder.iterdir():
        text = path.read_text()
        assert str(Path.home()) not in text and str(Path.cwd()) not in text and str(tmp_path) not in text


def test_the_hash_is_of_the_mechanism() -> None:
    base = check(Subject("a", pendulum()), Settings(states=2, engines=("pinocchio",)))
    noted = check(Subject("b", pendulum(notes=("n",))), Settings(states=2, engines=("pinocchio",)))
    other = check(Subject("c", pendulum(gravity=(0, 0, -1.62))), Settings(states=2, engines=("pinocchio",)))
    assert base.hash == noted.hash != other.hash


def test_a_record_survives_its_file(good: ModelResult, mixed: Data) -> None:
    record = Record.of(json.loads(json.dumps(mixed)))
    assert [model.label for model in record.models] == ["pendulum", NASTY, "gone"]
    whole = [(row.model, row.engine, row.quantity, row.status, row.error) for row in good.comparisons]
    read = [(row.model, row.engine, row.quantity, row.status, row.error) for row in record.models[0].comparisons]
    assert sorted(map(str, read)) == sorted(map(str, whole))
    assert {row.status for row in record.models[1].comparisons} == {"disagree", "unsupported"}
    assert [row.status for row in record.models[2].comparisons] == ["failed"]
    assert sum(record.distributions["bias"]["pinocchio"]) == good.comparisons[0].states


def test_only_unreadable_models_are_bad_input(good: ModelResult) -> None:
    data = as_data(SETTINGS, [good, failed("gone", "load", "no such file")], 1.0, ())
    assert code(compose(data)) == 2
    assert code(compose(as_data(SETTINGS, [good], 1.0, ("later",)))) == 130
    assert code(compose(as_data(SETTINGS, [good], 1.0, ()))) == 0


def test_an_engine_that_disagrees_alone_is_the_suspect_and_where_several_do_our_c_is(good: ModelResult) -> None:
    def decision(*wrong: str) -> str:
        data = json.loads(json.dumps(as_data(SETTINGS, [good], 1.0, ())))
        for row in data["comparisons"]:
            row["ok"] = not (row["engine"] in wrong and row["quantity"] == "mass_matrix")
        return str(compose(data).decisions[0])

    assert "none of" in decision()
    assert "our C:** mujoco (suspect)." in decision("mujoco")
    assert "pinocchio (against our C), mujoco (against our C)" in decision("pinocchio", "mujoco")


def test_an_unreadable_model_is_refused_in_its_parts_and_tags_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    reason = "r.urdf:1: no links; found: 0 other elements; rule: at least one <link>; remedy: run xacro"
    show(compose(as_data(SETTINGS, [failed("r", "load", reason)], 1.0, ())))
    reported = [line.strip(" •") for line in capsys.readouterr().out.splitlines()]
    expected = "r, symofros: load: r.urdf:1: no links", "found: 0 other elements", "rule: at least one <link>"
    assert [line for line in reported if line][:4] == [*expected, "remedy: run xacro"]
