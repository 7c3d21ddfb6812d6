"""Progress of jobs: what is written, and to whom."""

import io
import sys

import pytest

from ulna.errors import InputError
from ulna.scale import Progress
from ulna.scale.progress import reporter


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def _written(monkeypatch: pytest.MonkeyPatch, stream: io.StringIO, *reports: Progress) -> str:
    monkeypatch.setattr(sys, "stderr", stream)
    report = reporter(True, "job")
    for progress in reports:
        report(progress)
    return stream.getvalue()


def test_the_last_line_on_a_terminal_erases_a_longer_one(monkeypatch: pytest.MonkeyPatch) -> None:
    first, last = Progress(9, 10, 9e4, 1), Progress(10, 10, 1e5, 2)
    assert len(str(first)) > len(str(last))
    text = _written(monkeypatch, _Terminal(), first, last)
    assert text == f"\rjob: {first}\x1b[K\rjob: {last}\x1b[K\n"


def test_elsewhere_the_first_and_the_last_line_are_written(monkeypatch: pytest.MonkeyPatch) -> None:
    reports = [Progress(k, 3, float(k), k) for k in range(4)]
    assert _written(monkeypatch, io.StringIO(), *reports) == f"job: {reports[0]}\njob: {reports[3]}\n"


def test_what_is_not_done_is_not_100_percent() -> None:
    assert str(Progress(1999, 2000, 1.0, 0)) == "1999 of 2000 parts, 99 %"
    assert str(Progress(2000, 2000, 1.0, 0)) == "2000 of 2000 parts, 100 %"


def test_what_is_neither_a_flag_nor_a_function_is_refused() -> None:
    for wrong in ("no", None, 2.0, []):
        with pytest.raises(InputError, match="`progress` is .*; expected True or False"):
            reporter(wrong, "job")  # type: ignore[arg-type]
