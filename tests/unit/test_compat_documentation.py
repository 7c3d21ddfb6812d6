"""Docstrings of compatibility packages are completed by what arguments of the same name mean."""

from __future__ import annotations

import inspect
from typing import Any

from ulna.compat.documentation import documented, with_arguments

TEXTS = {"model": "The model.", "q": "Configuration (nq,).", "n": "How many."}


def test_missing_entries_come_in_the_order_of_the_arguments() -> None:
    doc = "A sum.\n\nArgs:\n    limit: The limit\n        of it.\n\nReturns:\n    The sum."
    assert with_arguments(doc, ["model", "limit", "q"], TEXTS) == (
        "A sum.\n\nArgs:\n    model: The model.\n    limit: The limit\n        of it.\n"
        "    q: Configuration (nq,).\n\nReturns:\n    The sum."
    )


def test_entries_that_are_written_stay() -> None:
    doc = "A sum.\n\nArgs:\n    q, v: State.\n    **more: Options."
    assert with_arguments(doc, ["model", "q", "v"], TEXTS) == (
        "A sum.\n\nArgs:\n    model: The model.\n    q, v: State.\n    **more: Options."
    )


def test_a_section_is_made_where_there_is_none() -> None:
    assert with_arguments("A sum.", ["q", "n"], TEXTS) == (
        "A sum.\n\nArgs:\n    q: Configuration (nq,).\n    n: How many."
    )
    doc = "A sum.\n\nRaises:\n    InputError: Always."
    assert with_arguments(doc, ["n"], TEXTS).startswith("A sum.\n\nArgs:\n    n: How many.\n\nRaises:")
    assert with_arguments(doc, ["other"], TEXTS) == doc


def test_a_common_result_is_described_where_nothing_is_said_of_it() -> None:
    texts = TEXTS | {"return": "True."}
    assert with_arguments("A sum.", ["n"], texts) == (
        "A sum.\n\nArgs:\n    n: How many.\n\nReturns:\n    True."
    )
    doc = "A sum.\n\nRaises:\n    InputError: Always."
    assert with_arguments(doc, [], texts) == (
        "A sum.\n\nReturns:\n    True.\n\nRaises:\n    InputError: Always."
    )
    doc = "A sum.\n\nReturns:\n    The sum."
    assert with_arguments(doc, ["other"], texts) == doc


def test_methods_of_all_kinds_are_completed_and_functions_of_one_argument_left_alone() -> None:
    @documented(TEXTS)
    class Robot:
        def f(self, model: Any, n: int) -> None:
            """Method."""

        @classmethod
        def g(cls, q: Any, n: int) -> None:
            """Class method."""

        @staticmethod
        def h(q: Any, n: int) -> None:
            """Static method."""

        def one(self, q: Any) -> None:
            """One argument."""

    assert inspect.getdoc(Robot.f) == "Method.\n\nArgs:\n    model: The model.\n    n: How many."
    for method in (Robot.g, Robot.h):
        assert str(inspect.getdoc(method)).endswith(
            "\n\nArgs:\n    q: Configuration (nq,).\n    n: How many."
        )
    assert inspect.getdoc(Robot.one) == "One argument."
