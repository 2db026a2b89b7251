"""A server for one person on this machine: the page, and answers to what its controls ask.

It listens on 127.0.0.1 only, answers nobody who calls it by another name, and serves a fixed list
of names. What is wrong with a request is said in JSON, {"problems": [{"path", "message"}, ...]},
with a status of 4xx, or 503 if the answer takes too long.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from .. import __version__
from . import page_files
from .answers import ANSWERS, problems_json
from .design import Design
from .start import start
from .workers import Unanswered, Workers

ADDRESS = "127.0.0.1"
MOST_BYTES = 1 << 17  # of a request
PATIENCE = 60  # s, for a silent connection
POLICY = "; ".join((
    "default-src 'none'", "script-src 'self'", "style-src 'self'", "connect-src 'self'",
    "img-src 'self' data: blob:", "base-uri 'none'", "form-action 'none'",
    "frame-ancestors 'none'",
))
JSON = "application/json; charset=utf-8"


class Refused(Exception):
    """A request that is not answered: its status, and the problems with it."""

    def __init__(self, status: HTTPStatus, message: str, path: str = "") -> None:
        self.status, self.problems = status, [(path, message)]
        super().__init__(message)


class Server(ThreadingHTTPServer):
    """Serves the page that begins with a design.

    Parameters
    ----------
    design : Design
        Shown first.
    port : int
        0 for a free one.

    Raises
    ------
    OSError
        If the port is taken.
    """

    daemon_threads = True
    request_queue_size = 128  # a connection for which there is no room waits for seconds
    allow_reuse_address = sys.platform != "win32"  # where it would share a port in use

    def __init__(self, design: Design, port: int = 0) -> None:
        self.workers = Workers()
        super().__init__((ADDRESS, port), Handler)
        self.workers.start()
        self.start = json.dumps(start(design), allow_nan=False).encode()

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://{ADDRESS}:{self.server_port}/"

    def server_close(self) -> None:
        """Give the port back, and end what is still at work."""
        super().server_close()
        self.workers.end()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Tell of faults, but not of a browser that has gone."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: Server
    server_version = f"rodimpact/{__version__}"
    sys_version = ""
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    wbufsize = -1
    timeout = PATIENCE

    def do_GET(self) -> None:
        """The page, its parts, and what it starts with."""
        if "Content-Length" in self.headers or "Transfer-Encoding" in self.headers:
            self.close_connection = True  # what it carries is not read
        self._answer(self._file)

    def do_POST(self) -> None:
        """What the controls ask for."""
        self._answer(self._reply)

    def _answer(self, made: Callable[[], tuple[int, str, bytes]]) -> None:
        try:
            self._check_host()
            self._send(*made())
        except Refused as refused:
            self.close_connection = True  # what was not read is no next request
            self._send(refused.status, JSON, problems_json(refused.problems))
        except (ConnectionError, TimeoutError):
            self.close_connection = True

    def _check_host(self) -> None:
        """A page of another site may have this address under its own name: answer none of those."""
        own = {f"{name}:{self.server.server_port}" for name in (ADDRESS, "localhost")}
        if self.headers.get_all("Host", []) not in [[name] for name in own]:
            raise Refused(HTTPStatus.FORBIDDEN, "this server answers to 127.0.0.1 only", "Host")
        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{name}" for name in own}:
            raise Refused(HTTPStatus.FORBIDDEN, "this server answers to its own page", "Origin")

    def _file(self) -> tuple[int, str, bytes]:
        name = self.path.partition("?")[0].removeprefix("/") or "page.html"
        if name == "start.json":
            return HTTPStatus.OK, JSON, self.server.start
        if name not in page_files.SERVED:
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such file", self.path[:80])
        return HTTPStatus.OK, page_files.kind_of(name), page_files.read(name).encode()

    def _reply(self) -> tuple[int, str, bytes]:
        question = self._body()
        if self.path not in ANSWERS:
            raise Refused(HTTPStatus.NOT_FOUND, "there is no such address", self.path[:80])
        try:
            status, answer = self.server.workers.ask(self.path, question)
        except Unanswered as error:
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, str(error)) from None
        return status, JSON, answer

    def _body(self) -> bytes:
        """What was sent, as JSON."""
        length = self.headers.get("Content-Length", "")
        self.close_connection = True  # unless all that was sent is read
        if not length.isdecimal() or "Transfer-Encoding" in self.headers:
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "send a Content-Length", "Content-Length")
        if len(length) > 9 or int(length) > MOST_BYTES:
            message = f"must be at most {MOST_BYTES} bytes"
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, message, "Content-Length")
        if self.headers.get_content_type() != "application/json":
            message = "send application/json"
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, message, "Content-Type")
        body = self.rfile.read(int(length))
        if len(body) < int(length):
            raise Refused(HTTPStatus.BAD_REQUEST, "the request is cut off", "Content-Length")
        self.close_connection = self.headers.get("Connection", "").lower() == "close"
        return body

    def _send(self, status: int, kind: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-store")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def send_error(
        self, code: int, message: str | None = None, explain: str | None = None  # noqa: ARG002
    ) -> None:
        """Mistakes that the library finds, in JSON too; an unknown method is the caller's."""
        self.close_connection = True
        self.request_version = self.protocol_version  # or the library leaves out the head
        status = HTTPStatus(code)
        if status == HTTPStatus.NOT_IMPLEMENTED:
            status = HTTPStatus.METHOD_NOT_ALLOWED
        self._send(status, JSON, problems_json([("", message or status.phrase)]))

    def log_message(self, format: str, *arguments: Any) -> None:  # noqa: A002  (the library's name)
        """Say nothing: a drag makes a request for every picture."""

