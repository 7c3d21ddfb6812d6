"""The page in a frame of a notebook, and where the kernel of the notebook runs."""

from __future__ import annotations

import importlib.util
import os
import sys
from typing import Literal
from urllib.parse import urlsplit

Place = Literal["here", "hub", "proxied hub", "colab", "vscode", "ssh"]

_NOTES: dict[Place, str] = {
    "here": "",
    "hub": "This notebook runs on a JupyterHub: its kernel is on another machine, where your browser does not reach "
    "{url}. This is a picture; <code>viewer.html('scene.html', motion)</code> as the last line of a cell displays "
    "a scene that can be turned, and moves. With the package <code>jupyter-server-proxy</code> in the notebook server "
    "and in the kernel, and after a restart of the server, the page itself is shown here. Where you can log in to "
    "that machine, <code>ssh -L {port}:localhost:{port} ...</code> brings it to {link}.",
    "proxied hub": "The page comes through jupyter-server-proxy, by {link}. Where it stays empty, that package is "
    "missing in the notebook server: install it there, and restart the server.",
    "colab": "This notebook runs on Colab, where your browser does not reach {url}. This is a picture; "
    "<code>viewer.html('scene.html', motion)</code> as the last line of a cell displays a scene that can be turned, "
    "and moves.",
    "vscode": "The page is at {link}. Where it stays empty the kernel runs on another machine: forward port {port} in "
    "VS Code's view <i>Ports</i>.",
    "ssh": "The page is at {link}. Where it stays empty, forward its port from your machine: "
    "<code>ssh -L {port}:localhost:{port} ...</code>",
}


def place_of_kernel() -> Place:
    """Where the kernel of a notebook runs, as far as the environment says."""
    if "google.colab" in sys.modules or "COLAB_RELEASE_TAG" in os.environ:
        return "colab"
    if "JUPYTERHUB_SERVICE_PREFIX" in os.environ or "JUPYTERHUB_USER" in os.environ:
        return "proxied hub" if has_proxy() and "JUPYTERHUB_SERVICE_PREFIX" in os.environ else "hub"
    if any(
        name in os.environ
        for name in ("VSCODE_PID", "VSCODE_IPC_HOOK_CLI", "CODESPACES", "REMOTE_CONTAINERS")
    ):
        return "vscode"
    return "ssh" if "SSH_CONNECTION" in os.environ else "here"


def has_proxy() -> bool:
    """Whether jupyter-server-proxy, with which a notebook server forwards ports, is installed for this kernel."""
    return importlib.util.find_spec("jupyter_server_proxy") is not None


def is_reachable(place: Place) -> bool:
    """Whether a user's browser can reach the page where the kernel runs."""
    return place not in ("hub", "colab")


def address(url: str, port: int) -> str:
    """Where a user's browser finds a page: its address, or its path on the JupyterHub that forwards it.

    Args:
        url: Address of the page.
        port: Its port.

    Returns:
        The address.
    """
    if place_of_kernel() != "proxied hub":
        return url
    query = urlsplit(url).query
    return f"{os.environ['JUPYTERHUB_SERVICE_PREFIX'].rstrip('/')}/proxy/{port}/{query and '?' + query}"


def note_html(url: str, port: int) -> str:
    """Where a page is and how it is reached from elsewhere; empty where the kernel runs on the user's machine.

    Args:
        url: Address of the page.
        port: Its port.

    Returns:
        The HTML text.
    """
    target = address(url, port)
    link = f'<a href="{target}" target="_blank">{target}</a>'
    note = _NOTES[place_of_kernel()].format(url=url, port=port, link=link)
    return f'<div style="font-size:smaller;opacity:0.8">{note}</div>' if note else ""


def frame_html(url: str, port: int) -> str:
    """A page in a frame, and a note on where it is; the note alone where the user's browser does not reach it.

    Args:
        url: Address of the page.
        port: Its port.

    Returns:
        The HTML text.
    """
    note = note_html(url, port)
    if not is_reachable(place_of_kernel()):
        return note
    return f'<iframe src="{address(url, port)}" width="100%" height="560" style="border:0"></iframe>{note}'
