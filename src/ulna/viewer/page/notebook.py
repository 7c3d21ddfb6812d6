"""The page in a frame of a notebook, and where the kernel of the notebook runs."""

from __future__ import annotations

import os
import sys
from typing import Literal

Place = Literal["here", "hub", "colab", "vscode", "ssh"]

_NOTES: dict[Place, str] = {
    "here": "",
    "hub": "This notebook runs on a JupyterHub: its kernel is on another machine, where your browser does not reach "
    "{url}. This is a picture; <code>viewer.html('scene.html')</code> writes a page with the motion that you can "
    "download and open. Where you can log in to that machine, <code>ssh -L {port}:localhost:{port} ...</code> "
    "brings the page itself to {link}.",
    "colab": "This notebook runs on Colab, where your browser does not reach {url}. This is a picture; "
    "<code>viewer.html('scene.html')</code> writes a page with the motion that you can download and open.",
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
        return "hub"
    if any(
        name in os.environ
        for name in ("VSCODE_PID", "VSCODE_IPC_HOOK_CLI", "CODESPACES", "REMOTE_CONTAINERS")
    ):
        return "vscode"
    return "ssh" if "SSH_CONNECTION" in os.environ else "here"


def is_reachable(place: Place) -> bool:
    """Whether a user's browser can reach the port of a page where the kernel runs."""
    return place not in ("hub", "colab")


def note_html(url: str, port: int) -> str:
    """Where a page is and how it is reached from elsewhere; empty where the kernel runs on the user's machine.

    Args:
        url: Address of the page.
        port: Its port.

    Returns:
        The HTML text.
    """
    link = f'<a href="{url}" target="_blank">{url}</a>'
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
    return f'<iframe src="{url}" width="100%" height="560" style="border:0"></iframe>{note}'
