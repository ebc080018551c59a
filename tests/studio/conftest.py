from __future__ import annotations

import http.client
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from fingertip import Design
from fingertip.studio.server import TOKEN_HEADER, StudioServer


@pytest.fixture(scope="session")
def design() -> Design:
    return Design.load("fsr400")


@pytest.fixture(scope="session")
def tables(design: Design) -> dict[str, Any]:
    found: dict[str, Any] = design.model_dump(mode="json")
    return found


@contextmanager
def serve(design: Design) -> Iterator[StudioServer]:
    with StudioServer(design, 0) as running:
        thread = threading.Thread(target=running.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        yield running
        running.shutdown()
        thread.join()


@pytest.fixture(scope="session")
def server(design: Design) -> Iterator[StudioServer]:
    with serve(design) as running:
        yield running


class Reply:
    def __init__(self, response: http.client.HTTPResponse) -> None:
        self.status = response.status
        self.headers = response.headers
        self.data = response.read()

    @property
    def content(self) -> Any:
        return json.loads(self.data)


def send(
    server: StudioServer, method: str, path: str, body: bytes | None = None, **headers: str | None
) -> http.client.HTTPConnection:
    """One request as the page sends it.

    A header given as None is left out, others replace the page's.
    """
    shown: dict[str, str | None] = {
        "Host": server.hosts[0],
        "Content-Type": "application/json" if body is not None else None,
        TOKEN_HEADER: server.token if method == "POST" else None,
    } | {name.replace("_", "-"): value for name, value in headers.items()}
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    connection.putrequest(method, path, skip_host=True)
    if body is not None and "Content-Length" not in shown:
        shown["Content-Length"] = str(len(body))
    for name, value in shown.items():
        if value is not None:
            connection.putheader(name, value)
    connection.endheaders(body)
    return connection


def ask(
    server: StudioServer, method: str, path: str, body: bytes | None = None, **headers: str | None
) -> Reply:
    connection = send(server, method, path, body, **headers)
    reply = Reply(connection.getresponse())
    connection.close()
    return reply


def post(server: StudioServer, name: str, tables: object, **more: str) -> Reply:
    return ask(
        server,
        "POST",
        f"/api/{name}",
        json.dumps({"client": "test", "tables": tables, **more}).encode(),
    )
