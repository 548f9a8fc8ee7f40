"""The list of the harness's commands, which is printed without importing any of them."""

import pytest

from symofros.commands.grammar import _SUMMARY
from validation.__main__ import command
from validation.commands import COMMANDS
from validation.dashboard.catalogue import TOPICS


@pytest.mark.parametrize("name", COMMANDS)
def test_a_line_of_the_list_is_the_first_sentence_of_the_command(name: str) -> None:
    assert command(name).get_short_help_str(limit=_SUMMARY) == COMMANDS[name].summary


def test_every_report_has_its_command() -> None:
    assert set(TOPICS) <= set(COMMANDS)
