"""What comes over the socket of the studio gets a reply that blames the request; the worker."""

from __future__ import annotations

import _thread
import contextlib
import http.client
import json
import socket
import threading
import time
import urllib.request
import webbrowser
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

from fingertip import Design
from fingertip.studio import answers
from fingertip.studio import server as server_module
from fingertip.studio.server import TOKEN_HEADER, StudioServer
from fingertip.studio.worker import NewestWinsWorker, StillWanted, SupersededError
from tests.conftest import run_fingertip
from tests.studio.conftest import serve

TABLES = '{"client": "a", "tables": {"skin": %s}}'


@pytest.fixture(scope="module")
def server(design: Design) -> Iterator[StudioServer]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(server_module, "render_studio", lambda design, token: b"page")
        with serve(design) as running:
            yield running


def post(server: StudioServer, body: bytes | str, path: str = "/api/download/design", **headers: str | None) -> bytes:
    """A request as the page sends it. A header given as None is left out, others replace the page's."""
    data = body.encode() if isinstance(body, str) else body
    shown: dict[str, str | None] = {
        "Host": server.hosts[0], TOKEN_HEADER: server.token, "Content-Type": "application/json",
        "Content-Length": str(len(data)),
    }  # fmt: skip
    shown |= {name.replace("_", "-"): value for name, value in headers.items()}
    lines = [f"POST {path} HTTP/1.1", *(f"{n}: {v}" for n, v in shown.items() if v is not None), "", ""]
    return "\r\n".join(lines).encode("utf-8") + data


def send(server: StudioServer, request: bytes) -> http.client.HTTPResponse | None:
    """Reply to raw bytes; None if there is none."""
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=20) as connection:
        with contextlib.suppress(OSError):  # it had replied before all was sent
            connection.sendall(request)
        reply = http.client.HTTPResponse(connection)
        try:
            reply.begin()
            reply.data = reply.read()  # type: ignore[attr-defined]
        except (OSError, http.client.HTTPException):
            return None
    return reply


def wait_for_handlers() -> None:
    while any("process_request_thread" in thread.name for thread in threading.enumerate()):
        time.sleep(0.002)


def list_malformed(server: StudioServer) -> Iterator[tuple[bytes, int, str]]:
    yield post(server, TABLES % f'{{"width_mm": {4000 * "9"}}}'), 400, "whole numbers of at most 18 digits"
    yield post(server, TABLES % r'{"width_mm": "\udfff"}'), 400, "not valid JSON"
    yield post(server, b'{"\xff": 1}'), 400, "not valid JSON"
    yield post(server, TABLES % (13 * "[" + 13 * "]")), 400, "nests tables and lists more than 12 deep"
    yield post(server, "{"), 400, "not valid JSON"
    yield post(server, "[]"), 400, "no JSON object"
    for body in ("{}", '{"client": 3, "tables": {}}'):
        yield post(server, body), 400, "not both tables and a client"
    for path in ("/api/nothing", "/api/download/step", "/parts"):
        yield post(server, TABLES % "{}", path), 404, "nothing at this address"
    yield post(server, "{}", Content_Type="text/plain"), 415, "application/json"
    for value in ("evil.example", "127.0.0.1", "127.0.0.1:1", None):
        yield post(server, "{}", Host=value), 403, "answers to"
    for name, values in {"Origin": ("http://evil.example", "null"), TOKEN_HEADER: (None, "wrong", "\xe9")}.items():
        for value in values:
            yield post(server, "{}", **{name: value}), 403, ""
    yield post(server, TABLES % '{"x": 1}', Origin=f"http://{server.hosts[1]}"), 200, "there is no such parameter"
    yield post(server, TABLES % '{"width_mm": NaN, "length_mm": 1e999}'), 200, "is not a finite number"


def test_malformed_requests_get_one_sentence(server: StudioServer, capfd: pytest.CaptureFixture[str]) -> None:
    for request, status, said in list_malformed(server):
        reply = send(server, request)
        assert reply is not None, request[:80]
        content: dict[str, Any] = json.loads(reply.data)  # type: ignore[attr-defined]
        assert (reply.status, set(content)) == (status, {"issues" if status == 200 else "error"}), request[:80]
        assert said in json.dumps(content), request[:80]
        assert "Access-Control-Allow-Origin" not in reply.headers
    wait_for_handlers()
    assert capfd.readouterr() == ("", "")


def test_checks_that_nobody_waits_for_are_given_up(server: StudioServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Twenty pages ask and are closed; the next one is answered, though each answer would take a minute."""
    begun = threading.Event()

    def work(design: Design, still_wanted: StillWanted) -> dict[str, Any]:
        begun.set()
        for _ in range(6000):
            still_wanted()
            time.sleep(0.01)
        return {}

    monkeypatch.setitem(answers.ANSWERS, "checks", work)  # type: ignore[call-overload]
    asked = [socket.create_connection(("127.0.0.1", server.server_port)) for _ in range(20)]
    for number, connection in enumerate(asked):
        request = post(server, TABLES.replace('"a"', f'"{number}"') % "{}")
        connection.sendall(request.replace(b"/download/design", b"/checks"))
    assert begun.wait(20)
    for connection in asked:
        connection.close()
    reply = send(server, post(server, TABLES % "{}"))
    assert reply is not None
    assert reply.headers["Content-Disposition"]
    wait_for_handlers()
    assert not server.worker._newest


def test_a_fault_of_an_answer_is_a_sentence_on_the_page_and_a_traceback_in_the_terminal(
    server: StudioServer, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(design: Design, still_wanted: StillWanted) -> dict[str, Any]:
        raise ZeroDivisionError("here")

    monkeypatch.setitem(answers.ANSWERS, "checks", fail)  # type: ignore[call-overload]
    reply = send(server, post(server, TABLES % "{}", "/api/checks"))
    assert reply is not None
    assert reply.status == 500
    assert "This is a bug in fingertip." in json.loads(reply.data)["error"]  # type: ignore[attr-defined]
    wait_for_handlers()
    assert "ZeroDivisionError: here" in capfd.readouterr().err


# Worker: one job at a time, and of each client the newest one


class Gate:
    """Job that runs until it is let go, and asks then whether it is still wanted."""

    def __init__(self, result: str) -> None:
        self.started, self.go, self.result = threading.Event(), threading.Event(), result

    def __call__(self, still_wanted: StillWanted) -> str:
        self.started.set()
        assert self.go.wait(10)
        still_wanted()
        return self.result


def start(pool: ThreadPoolExecutor, worker: NewestWinsWorker, client: str, gate: Gate) -> Future[str]:
    newest = worker._newest.get(client)
    future = pool.submit(worker.run, client, gate, never)
    while worker._newest.get(client) is newest:  # until it has joined the queue
        pass
    return future


def never() -> bool:
    return False


def test_newest_of_each_client_wins() -> None:
    worker, gates = NewestWinsWorker(), {name: Gate(name) for name in ("a1", "b1", "a2", "a3")}
    with ThreadPoolExecutor(8) as pool:
        running = {}
        for name in gates:
            running[name] = start(pool, worker, name[0], gates[name])
            if name == "a1":
                assert gates[name].started.wait(10)
        with pytest.raises(SupersededError):  # it never began
            running["a2"].result(10)
        assert not gates["a2"].started.is_set()
        for gate in gates.values():
            gate.go.set()
        with pytest.raises(SupersededError):  # it learned so between two steps
            running["a1"].result(10)
        assert running["b1"].result(10) == "b1"
        assert running["a3"].result(10) == "a3"
    assert not worker._newest
    worker.close()


def test_an_error_goes_to_who_asked_and_the_worker_goes_on() -> None:
    worker = NewestWinsWorker()

    def fail(still_wanted: StillWanted) -> Any:
        raise ZeroDivisionError("here")

    with pytest.raises(ZeroDivisionError, match="here"):
        worker.run("a", fail, never)
    assert worker.run("a", lambda wanted: 2, never) == 2
    worker.close()
    with pytest.raises(SupersededError):
        worker.run("a", lambda wanted: 2, never)


def test_a_browser_opens_the_page_at_its_address(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[bytes] = []

    def browse(address: str) -> bool:
        def follow() -> None:
            with urllib.request.urlopen(address, timeout=20) as page:
                opened.append(page.read())
            _thread.interrupt_main()

        threading.Thread(target=follow).start()
        return True

    monkeypatch.setattr(server_module, "render_studio", lambda design, token: b"page")
    monkeypatch.setattr(webbrowser, "open", browse)
    done = run_fingertip("studio", "--port", "0")
    assert (done.returncode, opened) == (0, [b"page"]), done.stderr
