"""Tests on clusters, none of which may wait for ever."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from support.hang_guard import ends_within


@pytest.fixture(autouse=True)
def _ends() -> Iterator[None]:
    with ends_within(1200):
        yield
