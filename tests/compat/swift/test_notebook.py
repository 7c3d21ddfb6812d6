"""The page is shown in the cell of a notebook, by either spelling of the argument."""

from __future__ import annotations

import contextlib
from typing import Any

import pytest

pytest.importorskip("spatialmath")
pytest.importorskip("viser")

from support.compat_packages import using


@pytest.mark.parametrize("arguments", [{"browser": "notebook"}, {"notebook": True}])
def test_the_page_is_shown_in_a_cell(arguments: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    with using("roboticstoolbox"):
        import swift
        from swift import _launch

        started: list[bool] = []
        shown: list[Any] = []
        monkeypatch.setattr(
            _launch.LaunchedEnvironment, "_start", lambda self, page, *rest: started.append(page)
        )
        monkeypatch.setattr(_launch.LaunchedEnvironment, "_in_notebook", lambda self: shown.append(self))
        monkeypatch.delenv("SWIFT_HEADLESS", raising=False)
        monkeypatch.delenv("ULNA_HEADLESS", raising=False)
        env = swift.Swift()
        with pytest.warns(FutureWarning) if "browser" in arguments else contextlib.nullcontext():
            env.launch(**arguments)
        assert started == [True]
        assert shown == [env]
