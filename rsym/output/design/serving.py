"""A page that is served to this computer alone, and what it asks of Python: meshes, files, verdict, lint.

Whoever asks must know a secret word in the address, and address this computer by its number or as localhost: pages of
other sites can do neither. All that comes in are numbers, for letters that the model has, in their ranges.
"""

from __future__ import annotations

import json
import secrets
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import MappingProxyType
from typing import Any
from urllib.parse import quote

from rsym.errors import RsymError, RsymWarning
from rsym.model.letters import real_number
from rsym.model.shape import Shape
from rsym.output.formats import FORMATS
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import AUTOMATIC, FIRST, mesh
from rsym.verify.lint.linting import lint
from rsym.verify.smoothness import verify_smoothness

LONGEST = 100_000  # bytes of a question: a thousand letters with long names
PATIENCE = 60.0  # seconds for a verdict; what is open then is told as undecided
KINDS = {".html": "text/html; charset=utf-8", "": "text/plain; charset=utf-8"}


class DesignServer(ThreadingHTTPServer):
    """Serves the page of a shape; `address` is what to open, `serve_forever` serves until it is interrupted.

    Examples
    --------
    >>> import rsym
    >>> with DesignServer(rsym.disc(1), "<!DOCTYPE html>", port=0) as server:
    ...     server.address.startswith("http://127.0.0.1:")
    True
    """

    daemon_threads = True

    def __init__(
        self,
        shape: Shape,
        html: str,
        *,
        port: int = 0,
        resolution: int | Sequence[int] | str = AUTOMATIC,
        force: bool = False,
    ) -> None:
        self.shape, self.html = shape, html
        self.mesh = partial(mesh, shape, resolution, force=force)
        self.shown = partial(mesh, shape, FIRST if resolution == AUTOMATIC else resolution, force=force)
        self.word = secrets.token_urlsafe(24)
        self.working = (
            threading.Lock()
        )  # one mesh or verdict at a time: each takes the memory and the processors it can
        try:
            super().__init__(("127.0.0.1", port), _Handler)
        except OSError as error:
            raise RsymError(
                f"cannot serve at port {port}: {error.strerror or error}", code="port", remedy="choose another port"
            ) from None

    @property
    def address(self) -> str:
        """The address of the page, with the secret word."""
        return f"http://127.0.0.1:{self.server_port}/{self.word}/"

    @property
    def hosts(self) -> tuple[str, ...]:
        """How a browser on this computer names this server."""
        return tuple(f"{name}:{self.server_port}" for name in ("127.0.0.1", "localhost"))


class _Handler(BaseHTTPRequestHandler):
    server: DesignServer
    server_version, sys_version = "rsym", ""

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is told on the terminal of each request."""

    def do_GET(self) -> None:
        """The page."""
        name = self._asked()
        if name == "":
            self._reply(200, self.server.html.encode(), KINDS[".html"])
        elif name is not None:
            self._refuse(404, "there is no such page")

    def do_POST(self) -> None:
        """What Python does for letters."""
        name = self._asked()
        if name is None:
            return
        service = _service(name)
        if service is None:
            self._refuse(404, "there is no such service")
            return
        try:
            letters = self._letters()
            with self.server.working, warnings.catch_warnings():
                warnings.simplefilter("ignore", RsymWarning)
                data, told = service(self.server, letters)
        except RsymError as error:
            self._refuse(400, str(error))
            return
        kind = KINDS.get(name[name.find(".") :] if "." in name else "", "application/octet-stream")
        self._reply(200, data, kind, {"X-Status": quote(told)})

    def _asked(self) -> str | None:
        """What is asked for behind the secret word; None where the question was refused."""
        origin = self.headers.get("Origin")
        known = self.headers.get("Host") in self.server.hosts and (
            origin is None or origin.removeprefix("http://") in self.server.hosts
        )
        _, word, *rest = [*self.path.partition("?")[0].split("/"), "", ""][:4]
        right = secrets.compare_digest(word.encode("utf-8", "replace"), self.server.word.encode())
        if not known or not right:
            self._refuse(403, "this page is for whoever has its address")
            return None
        return rest[0]

    def _letters(self) -> dict[str, float]:
        """The letters that are asked for: known ones, numbers, in their ranges."""
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdigit() or int(length) > LONGEST:
            raise RsymError(f"letters take at most {LONGEST} bytes", code="letters")
        try:
            found = json.loads(self.rfile.read(int(length)), parse_int=float)
        except (ValueError, RecursionError):
            raise RsymError("letters are a JSON object of names and numbers", code="letters") from None
        if not isinstance(found, dict):
            raise RsymError("letters are a JSON object of names and numbers", code="letters")
        return self.server.shape.letters.values_with(
            {name: float(real_number(value, f"the letter {name!r}")) for name, value in found.items()}
        )

    def _refuse(self, code: int, why: str) -> None:
        self._reply(code, why.encode(), KINDS[""])

    def _reply(self, code: int, data: bytes, kind: str, more: Mapping[str, str] = MappingProxyType({})) -> None:
        self.send_response(code)
        headers = {**more, "Content-Type": kind, "Content-Length": str(len(data)), "Cache-Control": "no-store"}
        headers |= {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer"}
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)


# What is sent, and what is known of it.
Service = Callable[[DesignServer, Mapping[str, float]], tuple[bytes, str]]


def _service(name: str) -> Service | None:
    """What answers a question."""
    body, _, suffix = name.partition(".")
    if body == "body" and f".{suffix}" in SUFFIXES:
        row = FORMATS[f".{suffix}"]
        encode = row.coloured or row.encode
        return lambda server, letters: _encoded(
            (server.shown if row.suffix == ".html" else server.mesh)(letters=letters), encode
        )
    return TEXTS.get(name)


def _encoded(body: Mesh, encode: Callable[[Mesh, str | None], bytes]) -> tuple[bytes, str]:
    status = body.status
    return encode(body, None), f"Resolution {status.resolution}: {status}"


SUFFIXES = (".stl", ".3mf", ".glb", ".html")
TEXTS: Mapping[str, Service] = {
    "verdict": lambda server, letters: (
        str(verify_smoothness(server.shape, letters=letters, timeout=PATIENCE)).encode(),
        "",
    ),
    "lint": lambda server, letters: (str(lint(server.shape.with_letters(letters))).encode(), ""),
}
