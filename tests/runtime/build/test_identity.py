"""Which code this is: sources and their places, and nothing that is built beside them."""

from __future__ import annotations

from pathlib import Path

from symofros.runtime.build.identity import source_digest


def test_build_products_do_not_change_the_source_digest(tmp_path: Path) -> None:
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "code.py").write_text("x = 1")
    before = source_digest(tmp_path)
    for built in ("node_modules/gyp/code.py", "part/__pycache__/code.c", "assets/page.html"):
        (tmp_path / built).parent.mkdir(parents=True)
        (tmp_path / built).write_text("built")
    assert source_digest(tmp_path) == before


def test_changed_text_or_place_changes_the_digest(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    source = tmp_path / "one" / "code.c"
    source.write_text("1")
    digests = {source_digest(tmp_path)}
    source.write_text("2")
    digests.add(source_digest(tmp_path))
    source.rename(tmp_path / "two" / "code.c")
    digests.add(source_digest(tmp_path))
    assert len(digests) == 3
