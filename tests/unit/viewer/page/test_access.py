"""Who may talk to the page."""

import pytest

from ulna.viewer.page.access import frame_ancestors, has_token, is_allowed, token_cookie

OURS = "localhost:8080"


@pytest.mark.parametrize(
    ("host", "origin"),
    [
        (OURS, "http://localhost:8080"),
        ("127.0.0.1:8080", "http://127.0.0.1:8080"),
        ("[::1]:8080", "http://[::1]:8080"),
        ("localhost:9000", "http://localhost:9000"),  # through a tunnel that listens elsewhere
        ("LOCALHOST:8080", "http://localhost:8080"),
        ("localhost", "http://localhost"),
        (OURS, None),  # a program, or the page itself being fetched
    ],
)
def test_own_pages_and_programs_may_connect(host: str, origin: str | None) -> None:
    assert is_allowed(host, origin)


@pytest.mark.parametrize(
    ("host", "origin"),
    [
        (OURS, "http://evil.example"),
        (OURS, "https://localhost.evil.example:8080"),
        (OURS, "http://localhost:3000"),  # another program's page on this machine
        (OURS, "http://127.0.0.1:8080"),
        (OURS, "null"),  # a file, or a page in a sandbox
        (OURS, "file://localhost:8080"),
        ("evil.example:8080", "http://evil.example:8080"),  # a name made to point here
        ("evil.example:8080", None),
        ("", None),
        (None, None),
        ("[::1", "http://[::1"),
        ("localhost:8080@evil.example", None),
    ],
)
def test_other_origins_may_not_connect(host: str | None, origin: str | None) -> None:
    assert not is_allowed(host, origin)


def test_an_open_host_still_refuses_foreign_pages() -> None:
    assert is_allowed("robot.lab:8080", "http://robot.lab:8080", any_host=True)
    assert not is_allowed("robot.lab:8080", "http://evil.example", any_host=True)


def test_a_token_is_known_from_the_address_or_a_cookie() -> None:
    assert has_token("", "/", None)
    assert has_token("secret", "/?token=secret", None)
    assert has_token("secret", "/?x=1&token=secret", "other=1")
    remembered = token_cookie("secret").partition(";")[0]
    assert has_token("secret", "/", remembered)
    assert has_token("secret", "/", f"a=b; {remembered}")
    for path, jar in (
        ("/", None),
        ("/?token=", None),
        ("/?token=Secret", None),
        ("/?token=sécret", None),
        ("/", "ulna=secret"),
        ("/", token_cookie("another").partition(";")[0]),
        ("/", '"\\";;='),
        ("http://[", None),
    ):
        assert not has_token("secret", path, jar)
    assert "HttpOnly" in token_cookie("secret")
    assert "SameSite=Strict" in token_cookie("secret")


def test_pages_of_this_machine_and_editors_may_frame_it_and_no_other() -> None:
    places = frame_ancestors("localhost:8080").split()
    assert places[:2] == ["frame-ancestors", "'self'"]
    assert {"http://localhost:*", "http://127.0.0.1:*", "vscode-webview:"} < set(places)
    assert "http://host.example:*" in frame_ancestors("host.example:8080").split()
    assert not any("[" in place or place == "http://:*" for place in frame_ancestors("[::1]:8080").split())
