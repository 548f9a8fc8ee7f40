"""Users' functions are named by file and line."""

from __future__ import annotations

import functools

from symofros.simulation.user_functions import named_function, raised_where


class Law:
    def __call__(self) -> None:
        raise ValueError("no")


def test_functions_are_named_by_their_file_and_line() -> None:
    line = Law.__call__.__code__.co_firstlineno
    assert named_function(Law.__call__) == f"Law.__call__ (test_user_functions.py:{line})"
    assert named_function(Law()).endswith(f"(test_user_functions.py:{line})")
    assert "partial" in named_function(functools.partial(print, 1)) and "print" in named_function(print)


def test_exceptions_are_named_by_the_line_that_raised_them() -> None:
    try:
        Law()()
    except ValueError as error:
        assert raised_where(error).startswith("ValueError('no') at test_user_functions.py:")
    assert raised_where(ValueError("never raised")) == "ValueError('never raised')"
