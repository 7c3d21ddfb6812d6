"""The exported WebAssembly module in a real browser: loaded by a page under a strict policy, equal to native results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna

pytestmark = pytest.mark.browser
KINDS = {".js": "text/javascript", ".wasm": "application/wasm", ".html": "text/html"}
POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'"
PAGE = '<!doctype html><title>panda</title><script type="module" src="page.js"></script>'
SCRIPT = """import { load } from "./panda.js";
load().then((robot) => { window.robot = robot; }, (error) => { window.failure = error.message; })
    .then(() => { document.documentElement.dataset.ended = ""; });
"""
ENDED = "html[data-ended]"  # a selector: the page's policy refuses to poll a JavaScript expression
CALL = "({ q, T }) => { const s = robot.ik(T); return { T: Array.from(robot.fk(q)), q: Array.from(s.q), met: s.success }; }"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: Any) -> Path:
    return ulna.export(ulna.load("panda"), ["fk", "ik"], to="wasm", path=tmp_path_factory.mktemp("web") / "x")


@pytest.fixture
def page(chromium: Any, folder: Path) -> Any:
    """A page whose files come from the exported folder, without a server."""

    def answer(route: Any) -> None:
        name = route.request.url.rsplit("/", 1)[1]
        made = {"index.html": PAGE.encode(), "page.js": SCRIPT.encode()}
        body = made[name] if name in made else (folder / name).read_bytes()
        headers = {"Content-Type": KINDS[Path(name).suffix], "Content-Security-Policy": POLICY}
        route.fulfill(body=body, headers=headers)

    context = chromium.new_context()
    context.route("http://robot.test/**", answer)
    page = context.new_page()
    yield page
    context.close()


def test_a_page_solves_as_native_code_does(page: Any) -> None:
    robot = ulna.load("panda")
    q = robot.random_configuration(seed=4)
    T = robot.fk(q)
    page.goto("http://robot.test/index.html")
    page.wait_for_selector(ENDED, state="attached")
    assert page.evaluate("window.failure") is None
    got = page.evaluate(CALL, {"q": q.tolist(), "T": T.ravel().tolist()})
    np.testing.assert_allclose(np.reshape(got["T"], (4, 4)), T, rtol=1e-14, atol=1e-14)
    assert got["met"]
    np.testing.assert_allclose(robot.fk(np.array(got["q"])), T, atol=3e-6)


def test_a_browser_without_simd_shows_a_message(page: Any) -> None:
    page.add_init_script("WebAssembly.validate = () => false;")
    page.goto("http://robot.test/index.html")
    page.wait_for_selector(ENDED, state="attached")
    assert "This browser has no WebAssembly SIMD; expected Chrome 91" in page.evaluate("window.failure")
