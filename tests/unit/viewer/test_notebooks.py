"""What notebooks display: pictures, figures, robots, and the page or how to see it."""

from __future__ import annotations

import base64
import html
import pickle
import subprocess
import sys
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

import ulna
from ulna.trajectory import quintic
from ulna.viewer import Viewer
from ulna.viewer.page import notebook

PNG = b"\x89PNG\r\n\x1a\n"
PLACES = ("COLAB_RELEASE_TAG", "JUPYTERHUB_SERVICE_PREFIX", "JUPYTERHUB_USER", "VSCODE_PID", "VSCODE_IPC_HOOK_CLI",
          "CODESPACES", "REMOTE_CONTAINERS", "SSH_CONNECTION")  # fmt: skip


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    for name in PLACES:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(notebook, "has_proxy", lambda: False)
    return monkeypatch


def test_pictures_display_themselves() -> None:
    viewer = Viewer(page=False)
    viewer.box((1, 1, 1))
    picture = viewer.picture(width=64, height=40)
    assert isinstance(picture, np.ndarray)
    assert (picture.shape, picture.dtype) == ((40, 64, 3), np.uint8)
    shown = picture._repr_png_()  # type: ignore[attr-defined]
    assert shown.startswith(PNG)
    image = pytest.importorskip("PIL.Image")
    import io

    np.testing.assert_array_equal(np.asarray(image.open(io.BytesIO(shown))), picture)
    assert repr(picture) == "<picture of 64 x 40 pixels: array (40, 64, 3), uint8>"
    assert repr(picture[:, :, 0]) == repr(np.asarray(picture[:, :, 0]))
    assert picture[:, :, 0]._repr_png_() is None  # type: ignore[attr-defined]
    assert type(picture / 255.0) is np.ndarray
    assert isinstance(picture.mean(), float)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(picture)), picture)


def test_pages_display_themselves_without_a_server(tmp_path: Path) -> None:
    """JupyterHub forbids frames of files and Colab serves none: the cell holds the page itself."""
    pytest.importorskip("viser")
    robot = ulna.load("ur5", visuals="simple")
    viewer = Viewer(page=False)
    viewer.add(robot)
    for file in (robot.save_html(tmp_path / "live.html"), viewer.html(tmp_path / "scene.html")):
        assert file == Path(file) and file.is_file()
        shown = file._repr_html_()  # type: ignore[attr-defined]
        assert shown.startswith('<iframe srcdoc="') and shown.endswith("</iframe>")
        content = shown.removeprefix('<iframe srcdoc="').partition('" width=')[0]
        assert html.unescape(content) == file.read_text(encoding="utf-8")
        assert pickle.loads(pickle.dumps(file)) == file
    script = robot.save_html(tmp_path / "live.js")
    assert script._repr_html_() is None  # type: ignore[attr-defined]
    file.unlink()
    assert file._repr_html_() is None  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "first", ["import ulna", "import matplotlib.pyplot", "from IPython.display import display"]
)
def test_plots_display_themselves_whatever_was_imported_first(first: str) -> None:
    """A figure was text unless pyplot had been imported before."""
    pytest.importorskip("IPython")
    pytest.importorskip("matplotlib")
    program = f"""
{first}
import matplotlib; matplotlib.use("Agg")
import numpy as np
from IPython.core.interactiveshell import InteractiveShell
import ulna
from ulna.trajectory import quintic
figure = quintic(np.zeros(3), np.ones(3), 1.0).plot()
data, _ = InteractiveShell.instance().display_formatter.format(figure)
assert data["image/png"][:8] == {PNG!r}, data
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_figure_can_still_be_pickled() -> None:
    pytest.importorskip("matplotlib")
    figure = quintic(np.zeros(3), np.ones(3), 1.0).plot()
    assert pickle.loads(pickle.dumps(figure))._repr_png_().startswith(PNG)


def test_robots_are_displayed_as_picture_and_table() -> None:
    robot = ulna.load("ur5", visuals="simple")
    text = robot._repr_html_()
    assert text is not None
    data = text.partition("base64,")[2].partition('"')[0]
    assert base64.b64decode(data).startswith(PNG)
    assert "white-space:pre" in text  # JupyterLab wraps the lines of a plain <pre>
    assert "max-width:100%" in text and "overflow-x:auto" in text  # as narrow as the window
    assert "shoulder_pan_joint" in text
    assert str(Viewer(page=False)._repr_html_()) == "None"
    viewer = Viewer(page=False)
    viewer.add(robot)
    assert "base64," in str(viewer._repr_html_())


def test_the_page_is_shown_or_explained(here: pytest.MonkeyPatch) -> None:
    pytest.importorskip("viser")
    with Viewer(port=0, browser=False) as viewer:
        viewer.box((1, 1, 1))
        port = viewer.url.rpartition(":")[2]
        shown = str(viewer._repr_html_())
        assert shown == f'<iframe src="{viewer.url}" width="100%" height="560" style="border:0"></iframe>'
        for variable, words, frame in (
            ("SSH_CONNECTION", f"ssh -L {port}:localhost:{port}", True),
            ("VSCODE_IPC_HOOK_CLI", "view <i>Ports</i>", True),
            ("JUPYTERHUB_SERVICE_PREFIX", "JupyterHub", False),
            ("COLAB_RELEASE_TAG", "Colab", False),
        ):
            here.setenv(variable, "1")
            shown = str(viewer._repr_html_())
            assert words in shown
            assert ("<iframe" in shown) is frame
            assert ("data:image/png" in shown) is not frame
            assert viewer.url in shown
            here.delenv(variable)


@pytest.mark.parametrize("query", ["", "?token=abc"])
def test_the_page_is_forwarded_by_a_hub_with_a_proxy(here: pytest.MonkeyPatch, query: str) -> None:
    here.setattr(notebook, "has_proxy", lambda: True)
    here.setenv("JUPYTERHUB_USER", "ann")
    assert notebook.place_of_kernel() == "hub"
    here.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ann/")
    assert notebook.is_reachable(notebook.place_of_kernel())
    shown = notebook.frame_html(f"http://localhost:8081{query}", 8081)
    assert shown.startswith(f'<iframe src="/user/ann/proxy/8081/{query}"')
    assert "jupyter-server-proxy" in shown and "http://localhost:8081" not in shown


def test_a_hub_reaches_the_page_under_its_name_with_the_token_only(here: pytest.MonkeyPatch) -> None:
    """jupyter-server-proxy passes the browser's Host on; hubs may share a machine between users."""
    pytest.importorskip("viser")
    here.setattr(notebook, "has_proxy", lambda: True)
    here.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ann/")
    with Viewer(port=0, browser=False) as viewer:
        port, token = urlsplit(viewer.url).port, parse_qs(urlsplit(viewer.url).query)["token"][0]
        assert f'src="/user/ann/proxy/{port}/?token={token}"' in str(viewer._repr_html_())
        for path, origin, status in (
            (f"/?token={token}", "https://hub.example.org", 200),
            (f"/?token={token}", None, 200),
            (f"/?token={token}", "https://evil.example.org", 403),
            ("/?token=guess", "https://hub.example.org", 403),
            ("/", None, 403),
        ):
            connection = HTTPConnection("127.0.0.1", port, timeout=30)
            headers = {"Host": "hub.example.org"} | ({"Origin": origin} if origin else {})
            connection.request("GET", path, headers=headers)
            assert connection.getresponse().status == status, (path, origin)
            connection.close()


def test_places_of_kernels(here: pytest.MonkeyPatch) -> None:
    assert notebook.place_of_kernel() == "here"
    for variable, place in (
        ("CODESPACES", "vscode"),
        ("JUPYTERHUB_USER", "hub"),
        ("COLAB_RELEASE_TAG", "colab"),
    ):
        here.setenv(variable, "x")
        assert notebook.place_of_kernel() == place
