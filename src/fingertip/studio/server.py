"""Server of the studio: HTTP on this machine alone, for its own page alone.

It listens on the loopback address. Every request must name it in its Host header, which keeps out names that another
page's server resolves to this address (DNS rebinding), and must carry the token of this run, which keeps out every page
and program that has not been given the address.
"""

from __future__ import annotations

import errno
import hmac
import json
import os
import secrets
import traceback
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from fingertip.design import Design
from fingertip.errors import FingertipError, Issue, StudioError
from fingertip.studio.answers import answer_all_checks, answer_checks, answer_parts, describe_issues, read_design
from fingertip.studio.downloads import DOWNLOADS
from fingertip.studio.page import render_locked, render_studio
from fingertip.studio.worker import NewestWinsWorker, StillWanted, SupersededError

ADDRESS = "127.0.0.1"
"""Address that the studio listens on."""
TOKEN_HEADER = "X-Fingertip-Token"
"""Header of a request that carries the token. A page of another origin cannot set it without being asked first."""
DEFAULT_PORT = 8350
MAX_PORT = 65535
_MAX_BODY_BYTES = 1_000_000
_TIMEOUT_S = 60.0
"""Time after which a connection that sends nothing is closed [s]."""
_ANSWERS: Mapping[str, Callable[[Design, StillWanted], dict[str, Any]]] = {
    "parts": answer_parts,
    "checks": answer_checks,
    "all-checks": answer_all_checks,
}
"""Name in the address -> function that answers."""
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class StudioServer(ThreadingHTTPServer):
    """Server of one design.

    Parameters
    ----------
    design
        Design that the form begins with.
    port
        Port to listen on; 0 takes any free one.

    Raises
    ------
    StudioError
        If the port cannot be listened on.
    """

    daemon_threads = True
    allow_reuse_address = os.name == "posix"  # elsewhere it would allow two servers on one port

    def __init__(self, design: Design, port: int = DEFAULT_PORT) -> None:
        self.design = design
        self.token = secrets.token_urlsafe(24)
        if not 0 <= port <= MAX_PORT:
            message = f"{port} is no port; choose 1024 to {MAX_PORT}, or 0 for any free one."
            raise StudioError(Issue("--port", message))
        try:
            super().__init__((ADDRESS, port), _Handler)
        except OSError as error:
            raise StudioError(Issue("--port", _describe_bind_error(port, error))) from error
        self.worker = NewestWinsWorker()
        # The page is made now, which also loads and warms up everything that a change of a slider needs.
        self.page = render_studio(design, self.token)

    @property
    def hosts(self) -> tuple[str, str]:
        """Values of the Host header that name this server."""
        return f"{ADDRESS}:{self.server_port}", f"localhost:{self.server_port}"

    @property
    def url(self) -> str:
        """Address of the page, with the token."""
        return f"http://{self.hosts[0]}/?token={self.token}"

    def server_close(self) -> None:
        """Close the socket and end the worker."""
        super().server_close()
        if worker := getattr(self, "worker", None):  # none if the port was in use
            worker.close()


class _RefusedRequestError(Exception):
    """A request that is answered with one sentence."""

    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


class _Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: StudioServer
    protocol_version = "HTTP/1.1"
    timeout = _TIMEOUT_S

    def do_GET(self) -> None:
        """Send the page."""
        try:
            self._check_host()
            address = urlsplit(self.path)
            if address.path != "/":
                raise _RefusedRequestError(HTTPStatus.NOT_FOUND, "There is nothing at this address.")
            given = parse_qs(address.query).get("token", [""])[0]
            is_allowed = self._is_token(given)
            status = HTTPStatus.OK if is_allowed else HTTPStatus.FORBIDDEN
            self._send(status, "text/html; charset=utf-8", self.server.page if is_allowed else render_locked())
        except _RefusedRequestError as refused:
            self._send_json(refused.status, {"error": str(refused)})

    def do_POST(self) -> None:
        """Answer a request of the page."""
        try:
            self._check_host()
            if not self._is_token(self.headers.get(TOKEN_HEADER, "")):
                raise _RefusedRequestError(HTTPStatus.FORBIDDEN, "The request carries not the token of this studio.")
            self._answer()
        except _RefusedRequestError as refused:
            self.close_connection = True  # its body may not have been read
            self._send_json(refused.status, {"error": str(refused)})
        except SupersededError:
            self._send_json(HTTPStatus.OK, {"superseded": True})
        except FingertipError as error:  # a result like any other: browsers log other statuses as errors
            self._send_json(HTTPStatus.OK, {"issues": describe_issues(error)})
        except Exception:
            traceback.print_exc()
            message = "The studio failed at this request; its terminal shows where. This is a bug in fingertip."
            self._send_json(HTTPStatus.INTERNAL_SERVER_ERROR, {"error": message})

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: the terminal is for messages to people."""

    def _answer(self) -> None:
        content = self._read_body()
        tables, client = content.get("tables"), content.get("client")
        if not isinstance(tables, dict) or not isinstance(client, str):
            raise _RefusedRequestError(HTTPStatus.BAD_REQUEST, "The request holds not both tables and a client.")
        _, api, name, *rest = [*urlsplit(self.path).path.split("/"), "", ""]
        kind, answer, download = name, _ANSWERS.get(name), DOWNLOADS.get(rest[0])
        if api != "api" or (answer is None and (kind != "download" or download is None)):
            raise _RefusedRequestError(HTTPStatus.NOT_FOUND, "There is nothing at this address.")
        design = read_design(tables, self.server.design)
        if answer:
            job = answer
            self._send_json(HTTPStatus.OK, self.server.worker.run(client, lambda wanted: job(design, wanted)))
        elif download:
            make_file = download[1]
            # A download is never superseded: it is a client of its own.
            made = self.server.worker.run(f"{client} {secrets.token_hex(8)}", lambda wanted: make_file(design, wanted))
            shown = {"Content-Disposition": f'attachment; filename="{made.name}"'}
            self._send(HTTPStatus.OK, made.content_type, made.data, shown)

    def _check_host(self) -> None:
        if self.headers.get("Host", "") not in self.server.hosts:
            message = f"This server answers to http://{self.server.hosts[0]} only."
            raise _RefusedRequestError(HTTPStatus.FORBIDDEN, message)
        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.server.hosts}:
            raise _RefusedRequestError(HTTPStatus.FORBIDDEN, "This server answers to its own page only.")

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self.server.token.encode())

    def _read_body(self) -> dict[str, Any]:
        if self.headers.get_content_type() != "application/json":
            raise _RefusedRequestError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "The request must be application/json.")
        text = self.headers.get("Content-Length", "")
        if not (text.isascii() and text.isdigit()):
            raise _RefusedRequestError(HTTPStatus.LENGTH_REQUIRED, "The request states not its length.")
        if int(text) > _MAX_BODY_BYTES:
            message = f"The request is longer than {_MAX_BODY_BYTES} bytes."
            raise _RefusedRequestError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, message)
        try:
            data = self.rfile.read(int(text))
        except OSError:  # time is up, or the page was closed
            raise _RefusedRequestError(HTTPStatus.REQUEST_TIMEOUT, "The request did not come to its end.") from None
        try:
            content = json.loads(data)
        except (ValueError, RecursionError):
            raise _RefusedRequestError(HTTPStatus.BAD_REQUEST, "The request is not valid JSON.") from None
        if not isinstance(content, dict):
            raise _RefusedRequestError(HTTPStatus.BAD_REQUEST, "The request is no JSON object.")
        return content

    def _send_json(self, status: HTTPStatus, content: Mapping[str, Any]) -> None:
        self._send(status, "application/json", json.dumps(content, separators=(",", ":")).encode())

    def _send(self, status: HTTPStatus, content_type: str, data: bytes, more: Mapping[str, str] | None = None) -> None:
        headers = {**_HEADERS, **(more or {}), "Content-Type": content_type, "Content-Length": str(len(data))}
        try:
            self.send_response(status)
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(data)
        except (BrokenPipeError, ConnectionResetError):  # the page was closed
            self.close_connection = True


def _describe_bind_error(port: int, error: OSError) -> str:
    remedy = "choose another with --port, or --port 0 for any free one."
    if error.errno == errno.EADDRINUSE:
        return f"{port} is in use, perhaps by another studio; {remedy}"
    return f"{port} cannot be listened on ({error.strerror or error}); {remedy}"
