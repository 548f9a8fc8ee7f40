"""The editor's page draws and edits the joint kinds that the table has."""

from __future__ import annotations

from symofros.studio.editor.joint_table import PAGE_FILE, joint_table


def test_the_page_has_the_table_of_joint_kinds() -> None:
    remedy = "run python -m symofros.studio.editor.joint_table"
    if PAGE_FILE.parent.exists():  # The page's source isn't installed.
        assert PAGE_FILE.read_text(encoding="utf-8") == joint_table(), remedy
