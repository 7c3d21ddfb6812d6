"""viser's page taken apart: whole again, named by content, and left alone where it is built in another way."""

import gzip
from pathlib import Path
from types import SimpleNamespace

import pytest

from ulna.viewer.page import client_files as client
from ulna.viewer.page.client_files import ClientFiles, response_to, unpacked_parts

viser = pytest.importorskip("viser", reason="viser, which serves the page, is not installed")
PAGE = Path(viser.__file__).parent / "client" / "build" / "index.html"


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))


def request(path: str, encodings: str = "gzip, br", **more: str) -> SimpleNamespace:
    return SimpleNamespace(path=path, headers={"Accept-Encoding": encodings} | more)


def test_the_parts_are_those_of_the_page() -> None:
    parts = unpacked_parts(PAGE.read_text(encoding="utf-8"))
    assert parts is not None
    code, style = gzip.decompress(parts["js"]), gzip.decompress(parts["css"])
    assert b"__viserMutable" in code
    assert b"data:image/jpeg;base64" not in code  # the light of a city
    assert style.lstrip().startswith((b"@", b":", b".", b"*", b"["))
    assert parts["wasm"].startswith(b"\0asm")


def test_what_a_browser_may_keep_has_a_name_of_its_content_and_the_page_is_asked_for_each_time() -> None:
    kept = ClientFiles(PAGE, "let early = 1 < 2;")
    page = response_to(kept, request("/?fixedDpr=1"))
    text = page.body.decode()
    assert page.headers["Cache-Control"] == "no-cache"
    assert text.index("let early = 1 < 2;") < text.index("import(")
    assert len(text) < 10_000
    for kind in ("js", "css", "wasm"):
        name = next(n for n in kept._files if n.endswith(kind))
        assert name[1:] in text
        file = response_to(kept, request(name))
        assert "immutable" in file.headers["Cache-Control"]
        assert int(file.headers["Content-Length"]) == len(file.body)
        assert (file.headers.get("Content-Encoding") == "gzip") == (kind != "wasm")


def test_nothing_else_is_answered() -> None:
    kept = ClientFiles(PAGE)
    for path in ("/etc/passwd", "/ulna-0.js", "/../x", "//", "/ulna-"):
        assert response_to(kept, request(path)) is None
    assert response_to(kept, request("/", Upgrade="websocket")) is None
    assert response_to(None, request("/")) is None
    script = next(n for n in kept._files if n.endswith("js"))
    assert response_to(kept, request(script, "identity")) is None


@pytest.mark.parametrize("change", [("data-p", "data-q"), ("gzWasm", "wasm"), ('data-ss="', 'data-ss="1')])
def test_a_page_that_is_built_in_another_way_is_served_as_it_is(
    tmp_path: Path, change: tuple[str, str]
) -> None:
    other = tmp_path / "index.html"
    other.write_text(PAGE.read_text(encoding="utf-8").replace(*change), encoding="utf-8")
    assert response_to(ClientFiles(other), request("/")) is None


def test_the_client_archive_is_unpacked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    first = ClientFiles(PAGE)._files
    monkeypatch.setattr(client, "unpacked_parts", lambda _: pytest.fail("it should be on disk"))
    again = ClientFiles(PAGE)._files
    assert {n: f.content for n, f in again.items()} == {n: f.content for n, f in first.items()}
