"""The page that viser serves, taken apart so that a browser can keep its program and start sooner the next time.

viser's page is one file: style, program and a decoder, compressed and written in letters of a text. A browser has to
unpack and compile it at every visit. Here each part is a file, with a name that changes with its content,
which a browser keeps together with what it compiled. A page that is built in another way is served as it is.
"""

from __future__ import annotations

import gzip
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from ulna import disk_cache as cache
from ulna.system.cached import cached_property

_FORMAT = "ulna client 1"
_PACKED_SCRIPT = re.compile(
    r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">.*?</script>', re.DOTALL
)
_ALPHABET = re.compile(r'const A=("(?:[^"\\]|\\.)*");')
_DECODER = re.compile(r'const gzWasm=("(?:[^"\\]|\\.)*");')
# the default environment map of a city, embedded in the program; our pages always set another one
_DEFAULT_ENVIRONMENT = re.compile(rb"`data:image/jpeg;base64,[A-Za-z0-9+/=]{20000,}`")
_CONTENT_TYPES = {
    "js": "text/javascript; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "wasm": "application/wasm",
}
_CACHE_FOREVER = "private, max-age=31536000, immutable"
_START_SCRIPT = """<script type="module">
globalThis.__viserZstdWasm = await WebAssembly.compileStreaming(fetch("{wasm}"));
await import("./{js}");
</script>"""


@final
@dataclass(frozen=True)
class ServedFile:
    """A response body: its content type, whether it is compressed with gzip, its cache control, its bytes."""

    kind: str
    zipped: bool
    keep: str
    content: bytes


@final
class ClientFiles:
    """The files of viser's page, by their names.

    Args:
        page: viser's page.
        early: A program that is to run before viser's.
    """

    def __init__(self, page: Path, early: str = "") -> None:
        self._page, self._early = page, early

    def file(self, path: str) -> ServedFile | None:
        """The file of a request's path; None where there is none, or the page cannot be taken apart."""
        return self._files.get(path.partition("?")[0])

    @cached_property
    def _files(self) -> dict[str, ServedFile]:
        text = self._page.read_text(encoding="utf-8")
        parts = _cached_parts(text)
        if parts is None:
            return {}
        names = {kind: f"ulna-{cache.key(content)[:16]}.{kind}" for kind, content in parts.items()}
        files = {
            f"/{names[kind]}": ServedFile(_CONTENT_TYPES[kind], kind != "wasm", _CACHE_FOREVER, content)
            for kind, content in parts.items()
        }
        head = f"""<script>{self._early}</script>
<link rel="stylesheet" href="{names["css"]}"><link rel="modulepreload" href="{names["js"]}">
{_START_SCRIPT.format(**names)}"""
        page = _PACKED_SCRIPT.sub(lambda _: head, text)
        files["/"] = ServedFile("text/html; charset=utf-8", False, "no-cache", page.encode())
        return files


def _cached_parts(text: str) -> dict[str, bytes] | None:
    """The parts of a page, from disk where it was taken apart before."""
    name = cache.key(_FORMAT, text)
    data = cache.read(name)
    if data is None:
        parts = unpacked_parts(text)
        if parts is None:
            return None
        head = json.dumps({kind: len(content) for kind, content in parts.items()}).encode()
        data = len(head).to_bytes(4, "little") + head + b"".join(parts.values())
        cache.write(name, data)
    start = 4 + int.from_bytes(data[:4], "little")
    out = {}
    for kind, length in json.loads(data[4:start]).items():
        out[kind] = data[start : start + length]
        start += length
    return out


def unpacked_parts(text: str) -> dict[str, bytes] | None:
    """Program and style of a page, compressed with gzip, and its decoder; None where they are not found."""
    packed, letters, decoder = (pattern.search(text) for pattern in (_PACKED_SCRIPT, _ALPHABET, _DECODER))
    if packed is None or letters is None or decoder is None:
        return None
    try:
        import zstandard

        alphabet = json.loads(letters.group(1))
        content = zstandard.ZstdDecompressor().decompress(_from_base88(packed.group(1), alphabet))
        wasm = gzip.decompress(_from_base88(json.loads(decoder.group(1)), alphabet))
    except Exception:  # built in another way; the page as it is does as well
        return None
    style, program = int(packed.group(2)), int(packed.group(3))
    if len(content) != style + program or not wasm.startswith(b"\0asm"):
        return None
    code = _DEFAULT_ENVIRONMENT.sub(b"null", content[style:])
    return {"js": gzip.compress(code, 6), "css": gzip.compress(content[:style], 6), "wasm": wasm}


def _from_base88(text: str, alphabet: str) -> bytes:
    """Bytes from letters: five digits in base 88 for four bytes, one more digit than bytes at the end."""
    value = np.zeros(128, dtype=np.int64)
    value[np.frombuffer(alphabet.encode("ascii"), np.uint8)] = np.arange(len(alphabet))
    digits = value[np.frombuffer(text.encode("ascii"), np.uint8)]
    full_groups = len(digits) // 5 * 5
    weights = len(alphabet) ** np.arange(4, -1, -1)
    out = (digits[:full_groups].reshape(-1, 5) @ weights).astype(">u4").tobytes()
    last_digits = digits[full_groups:]
    if len(last_digits):
        out += int(last_digits @ weights[-len(last_digits) :]).to_bytes(len(last_digits) - 1, "big")
    return out


def response_to(client: ClientFiles | None, request: Any) -> Any:
    """The response of a server of `websockets` to a request.

    Args:
        client: The files of the page; None where they are not known.
        request: The request.

    Returns:
        The response, or None to leave it to viser.
    """
    if client is None or request.headers.get("Upgrade"):
        return None
    file = client.file(request.path)
    if file is None or "gzip" not in request.headers.get(
        "Accept-Encoding", ""
    ):  # viser's page works for every client
        return None
    from websockets.datastructures import Headers
    from websockets.http11 import Response

    headers = Headers({"Content-Type": file.kind, "Cache-Control": file.keep})
    headers["Content-Length"] = str(len(file.content))
    if file.zipped:
        headers["Content-Encoding"] = "gzip"
    return Response(200, "OK", headers, file.content)
