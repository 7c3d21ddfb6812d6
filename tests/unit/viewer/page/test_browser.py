"""Whether anyone can look."""

import sys
import webbrowser
from types import SimpleNamespace

import pytest

from ulna.viewer.page import browser as screen


@pytest.fixture
def linux(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "ULNA_HEADLESS", "SSH_CONNECTION"):
        monkeypatch.delenv(name, raising=False)
    opened: list[str] = []
    browser = SimpleNamespace(name="firefox", open=lambda url: opened.append(url) or True)
    monkeypatch.setattr(webbrowser, "get", lambda name=None: browser)
    monkeypatch.opened = opened  # type: ignore[attr-defined]
    return monkeypatch


def test_no_display_is_no_screen(linux: pytest.MonkeyPatch) -> None:
    assert not screen.has_screen()
    assert not screen.open_browser("http://localhost:1")
    assert linux.opened == []  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_a_display_and_a_browser_are_a_screen(linux: pytest.MonkeyPatch, name: str) -> None:
    linux.setenv(name, ":0")
    assert screen.has_screen()
    assert screen.somebody_can_look()
    assert screen.open_browser("http://localhost:1")
    assert linux.opened == ["http://localhost:1"]  # type: ignore[attr-defined]


def test_a_browser_in_the_terminal_does_not_count(linux: pytest.MonkeyPatch) -> None:
    linux.setenv("DISPLAY", ":0")
    linux.setattr(webbrowser, "get", lambda name=None: SimpleNamespace(name="/usr/bin/w3m"))
    assert not screen.has_screen()


def test_no_browser_is_no_screen(linux: pytest.MonkeyPatch) -> None:
    def none(name: str | None = None) -> None:
        raise webbrowser.Error("could not locate runnable browser")

    linux.setenv("DISPLAY", ":0")
    linux.setattr(webbrowser, "get", none)
    assert not screen.has_screen()


def test_the_environment_can_say_no(linux: pytest.MonkeyPatch) -> None:
    linux.setenv("DISPLAY", ":0")
    linux.setenv("ULNA_HEADLESS", "1")
    assert not screen.has_screen()
    assert not screen.somebody_can_look()


def test_the_page_is_reachable_through_a_tunnel(linux: pytest.MonkeyPatch) -> None:
    terminal = SimpleNamespace(isatty=lambda: True)
    linux.setattr(sys, "stdin", terminal)
    linux.setattr(sys, "stdout", terminal)
    assert screen.somebody_can_look()
    assert not screen.has_screen()
