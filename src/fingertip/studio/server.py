"""Server of the studio: HTTP on this machine alone, for its own page alone.

It listens on the loopback address. Every request must name it in its Host header, which keeps out
names that another page's server resolves to this address (DNS rebinding), and must carry the token
of this run, which keeps out every page and program that has not been given the address.
"""

from __future__ import annotations

import contextlib
import errno
import hmac
import json
import os
import secrets
import socket
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, NamedTuple
from urllib.parse import SplitResult, parse_qs, urlsplit

from fingertip.design import Design
from fingertip.design.design_file import flatten
from fingertip.foundation.errors import DesignError, FingertipError, Issue, StudioError
from fingertip.foundation.tables import UnusableTomlError, check_values
from fingertip.studio import answers
from fingertip.studio.form_page import render_locked, render_studio
from fingertip.studio.worker import NewestWinsWorker, SupersededError

ADDRESS = "127.0.0.1"
"""Address that the studio listens on."""
TOKEN_HEADER = "X-Fingertip-Token"
"""Header that carries the token; a page of another origin cannot set it unasked."""
MAX_PORT = 65535
_TIMEOUT_S = 60.0
"""Time after which a connection that sends nothing is closed [s]."""
_HTML = "text/html; charset=utf-8"
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class StudioServer(ThreadingHTTPServer):
    """Server of one design. Raises StudioError."""

    request_queue_size = 128  # a connection beyond them waits a second before it tries again
    allow_reuse_address = os.name == "posix"  # elsewhere it would allow two servers on one port

    def __init__(self, design: Design, port: int) -> None:
        self.design = design
        self.token = secrets.token_urlsafe(24)
        if not 0 <= port <= MAX_PORT:
            message = f"{port} is no port; choose 1024 to {MAX_PORT}, or 0 for any free one."
            raise StudioError(Issue("--port", message))

        try:
            super().__init__((ADDRESS, port), _Handler)
        except OSError as error:
            problem = f"cannot be listened on ({error.strerror or error})"
            if error.errno == errno.EADDRINUSE:
                problem = "is in use, perhaps by another studio"

            message = f"{port} {problem}; choose another with --port, or --port 0 for any free one."
            raise StudioError(Issue("--port", message)) from error

        self.worker = NewestWinsWorker()
        self.finder = answers.BandFinder(design)
        # The page is made now, which also loads and warms up everything that a change of a slider
        # needs.
        self.page = render_studio(design, self.token)

    @property
    def hosts(self) -> tuple[str, str]:
        """Values of the Host header that name this server."""
        return f"{ADDRESS}:{self.server_port}", f"localhost:{self.server_port}"

    @property
    def url(self) -> str:
        return f"http://{self.hosts[0]}/?token={self.token}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print an unexpected exception, but not the end of a connection."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)

    def server_close(self) -> None:
        super().server_close()
        worker = getattr(self, "worker", None)
        if worker:  # none if the port was in use
            worker.close()


class _RefusedRequestError(Exception):
    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


@dataclass(frozen=True)
class _Request:
    """Request of the page: values of its form, and the field in hand, if any."""

    tables: dict[str, Any]
    client: str
    field: str


class _Reply(NamedTuple):
    status: HTTPStatus
    content_type: str
    data: bytes
    headers: Mapping[str, str] = {}


class _Handler(BaseHTTPRequestHandler):
    server: StudioServer
    protocol_version = "HTTP/1.1"
    timeout = _TIMEOUT_S

    def do_GET(self) -> None:
        self._reply(self._show_page)

    def do_POST(self) -> None:
        self._reply(self._answer)

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: the terminal is for messages to people."""

    def _reply(self, answer: Callable[[], _Reply]) -> None:
        try:
            self._check_host()
            reply = answer()
        except _RefusedRequestError as refused:
            self.close_connection = True  # its body may not have been read
            reply = _make_json({"error": str(refused)}, refused.status)
        except SupersededError:
            reply = _make_json({"superseded": True})
        except FingertipError as error:
            # A result like any other: browsers log other statuses as errors.
            reply = _make_json({"issues": answers.describe_issues(error)})
        except Exception:
            traceback.print_exc()
            message = (
                "The studio failed at this request; its terminal shows where. This is a bug "
                "in fingertip."
            )
            reply = _make_json({"error": message}, HTTPStatus.INTERNAL_SERVER_ERROR)

        self._send(reply)

    def _show_page(self) -> _Reply:
        address = self._split_address()
        if address.path != "/":
            raise _RefusedRequestError(HTTPStatus.NOT_FOUND, "There is nothing at this address.")
        if not self._is_token(parse_qs(address.query).get("token", [""])[0]):
            return _Reply(HTTPStatus.FORBIDDEN, _HTML, render_locked())

        return _Reply(HTTPStatus.OK, _HTML, self.server.page)

    def _answer(self) -> _Reply:
        if not self._is_token(self.headers.get(TOKEN_HEADER, "")):
            raise _RefusedRequestError(
                HTTPStatus.FORBIDDEN, "The request carries not the token of this studio."
            )

        request = self._read_content()
        _, api, name, *rest = [*self._split_address().path.split("/"), "", ""]
        at_once = answers.AT_ONCE.get(name)
        before = self.server.design
        file = dict(flatten(request.tables)).get("bone.adapter_file", "")

        if file not in ("", before.bone.adapter_file):
            message = (
                "is a file of this machine, which a page may not choose; name it when you "
                "start the studio."
            )
            raise DesignError(Issue("bone.adapter_file", message))

        if api == "api" and at_once:
            finder = self.server.finder
            suggestion = at_once(finder, request.tables, request.field, self._raise_if_gone)
            return _make_json(_list_fields(suggestion))

        is_download = name == "download"
        answer: Callable[..., answers.Answer | answers.Download] | None
        if is_download:
            answer = answers.DOWNLOADS.get(rest[0], ("", None))[1]
        else:
            answer = answers.ANSWERS.get(name)
        if api != "api" or not answer:
            raise _RefusedRequestError(HTTPStatus.NOT_FOUND, "There is nothing at this address.")

        client = request.client
        if is_download:  # it is never superseded: it is a client of its own
            client = f"{client} {secrets.token_hex(8)}"

        result = self.server.worker.run(
            client,
            lambda still_wanted: answer(answers.read_design(request.tables, before), still_wanted),
            self._has_gone,
        )
        if not isinstance(result, answers.Download):
            return _make_json(_list_fields(result))

        headers = {"Content-Disposition": f'attachment; filename="{result.name}"'}
        return _Reply(HTTPStatus.OK, result.content_type, result.data, headers)

    def _check_host(self) -> None:
        if self.headers.get("Host", "") not in self.server.hosts:
            message = f"This server answers to http://{self.server.hosts[0]} only."
            raise _RefusedRequestError(HTTPStatus.FORBIDDEN, message)

        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.server.hosts}:
            raise _RefusedRequestError(
                HTTPStatus.FORBIDDEN, "This server answers to its own page only."
            )

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode(), self.server.token.encode())

    def _split_address(self) -> SplitResult:
        try:
            return urlsplit(self.path)
        except ValueError:
            raise _RefusedRequestError(
                HTTPStatus.BAD_REQUEST, "The address of the request is none."
            ) from None

    def _read_content(self) -> _Request:
        if self.headers.get_content_type() != "application/json":
            raise _RefusedRequestError(
                HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "The request must be application/json."
            )

        data = b""
        with contextlib.suppress(OSError):  # time is up, or the page was closed
            data = self.rfile.read(int(self.headers["Content-Length"]))

        try:
            content = json.loads(data)
            # Not every text of JSON can be written.
            json.dumps(content, ensure_ascii=False).encode()
        except (ValueError, RecursionError):
            raise _RefusedRequestError(
                HTTPStatus.BAD_REQUEST, "The request is not valid JSON."
            ) from None

        if not isinstance(content, dict):
            raise _RefusedRequestError(HTTPStatus.BAD_REQUEST, "The request is no JSON object.")

        tables = content.get("tables")
        client = content.get("client")
        field = content.get("field", "")

        if not (isinstance(tables, dict) and isinstance(client, str) and isinstance(field, str)):
            raise _RefusedRequestError(
                HTTPStatus.BAD_REQUEST, "The request holds not both tables and a client."
            )

        try:
            check_values(tables)
        except UnusableTomlError as error:
            raise _RefusedRequestError(HTTPStatus.BAD_REQUEST, f"The request {error}.") from None

        return _Request(tables, client, field)

    def _raise_if_gone(self) -> None:
        if self._has_gone():
            raise SupersededError

    def _has_gone(self) -> bool:
        """Return whether the page was closed, or has given this request up."""
        self.connection.settimeout(0)
        try:
            return not self.connection.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return False
        except OSError:
            return True
        finally:
            self.connection.settimeout(self.timeout)

    def _send(self, reply: _Reply) -> None:
        headers = {**_HEADERS, **reply.headers, "Content-Type": reply.content_type}
        try:
            self.send_response(reply.status)
            for name, value in headers.items():
                self.send_header(name, value)

            self.send_header("Content-Length", str(len(reply.data)))
            self.end_headers()
            self.wfile.write(reply.data)
        except OSError:  # the page was closed
            self.close_connection = True


def _list_fields(answer: answers.Answer) -> dict[str, Any]:
    return {name: value for name, value in vars(answer).items() if value is not None}


def _make_json(content: Mapping[str, Any], status: HTTPStatus = HTTPStatus.OK) -> _Reply:
    return _Reply(status, "application/json", json.dumps(content, separators=(",", ":")).encode())
