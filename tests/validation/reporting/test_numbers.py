"""Numbers as reports show them."""

import pytest

from validation.reporting.numbers import counted


@pytest.mark.parametrize(
    ("number", "noun", "said"),
    [
        (1, "quantity", "1 quantity"),
        (2, "quantity", "2 quantities"),
        (2, "way", "2 ways"),
        (12_000, "key", "12 000 keys"),
    ],
)
def test_nouns_follow_their_numbers(number: int, noun: str, said: str) -> None:
    assert counted(number, noun) == said
