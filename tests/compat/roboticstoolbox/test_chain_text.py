"""Chains written as text: whatever stands in the brackets has a value or is refused, and at once."""

from __future__ import annotations

import pytest

pytest.importorskip("spatialmath")

from support.compat_packages import using
from ulna.errors import FormatError, UnknownName

DEEP = 100_000


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Rx(9**9**9**9)", "has no value"),
        ("Rx(1e308*1e308)", "is inf; expected a finite number"),
        ("Rx((-1)**0.5)", "has no value"),
        ("Rx(1/0)", "has no value: (float )?division by zero"),
        ("Rx(" + "-" * DEEP + "1)", "is no arithmetic expression"),
        ("Rx(" + "1+" * DEEP + "1)", "is no arithmetic expression"),
        ("Rx(" + "(" * DEEP + ")" * DEEP + ")", "is no arithmetic expression"),
        ("Rx(" + "9" * 6000 + ")", "is no arithmetic expression"),
        ("Rx(q" + "1" * 6000 + ")", "No name in a chain"),
        ("R(" * DEEP, "is not closed"),
    ],
    ids=range(10),
)
def test_expressions_without_a_value_are_refused(text: str, said: str) -> None:
    with using("roboticstoolbox"):
        from roboticstoolbox.tools.chains import trchain

        with pytest.raises((FormatError, UnknownName), match=said) as refused:
            trchain(text, [0.5])
        assert len(str(refused.value)) < 4100
        assert trchain("Rx(2 * q1 - 1) Tz(3**2)", [0.5])[2, 3] == 9.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("rx(q1) tz(1)", r"'rx\(q1\) tz\(1\)' in .* is no transform"),
        ("Sx(3) Tz(1)", r"'Sx\(3\)' in .* is no transform"),
        ("Rx 0.3 Tz(1)", "'Rx 0.3' in .* is no transform"),
        ("Rx(q1) Tz(1) y", "'y' in .* is no transform"),
        ("Tz(1))", r"'\)' in .* is no transform"),
        ("Rx(q1) + Tz(1)", r"'\+' in .* is no transform"),
    ],
)
def test_what_is_no_transform_is_refused(text: str, said: str) -> None:
    with using("roboticstoolbox"):
        from roboticstoolbox.tools.chains import trchain

        with pytest.raises(FormatError, match=said):
            trchain(text, [0.5])
        for between in ("", " ", "\n", " * ", "*", ", ", " @ ", "."):
            assert trchain(f" Tx(q1){between}Tz(1) ", [0.5])[:3, 3].tolist() == [0.5, 0.0, 1.0]
