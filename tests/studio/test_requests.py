"""What comes over the socket of the studio gets a reply that blames the request; the worker."""

from __future__ import annotations

import _thread
import json
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
from tests.studio.conftest import ask, post, send, serve

TABLES = '{"client": "a", "tables": {"skin": %s}}'


@pytest.fixture(scope="module")
def server(design: Design) -> Iterator[StudioServer]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(server_module, "render_studio", lambda design, token: b"page")
        with serve(design) as running:
            yield running


def wait_for_handlers() -> None:
    while any("process_request_thread" in thread.name for thread in threading.enumerate()):
        time.sleep(0.002)


DOWNLOAD = "/api/download/design"
MALFORMED: list[tuple[str, str | bytes, dict[str, str | None], int, str]] = [
    (
        DOWNLOAD,
        TABLES % f'{{"width_mm": {4000 * "9"}}}',
        {},
        400,
        "whole numbers of at most 18 digits",
    ),
    (DOWNLOAD, TABLES % r'{"width_mm": "\udfff"}', {}, 400, "not valid JSON"),
    (DOWNLOAD, b'{"\xff": 1}', {}, 400, "not valid JSON"),
    (DOWNLOAD, TABLES % (13 * "[" + 13 * "]"), {}, 400, "nests tables and lists more than 12 deep"),
    (DOWNLOAD, "{", {}, 400, "not valid JSON"),
    (DOWNLOAD, "[]", {}, 400, "no JSON object"),
    *(
        (DOWNLOAD, body, {}, 400, "not both tables and a client")
        for body in ("{}", '{"client": 3, "tables": {}}')
    ),
    *(
        (path, TABLES % "{}", {}, 404, "nothing at this address")
        for path in ("/api/nothing", "/api/download/step", "/parts")
    ),
    (DOWNLOAD, "{}", {"Content-Type": "text/plain"}, 415, "application/json"),
    *(
        (DOWNLOAD, "{}", {"Host": host}, 403, "answers to")
        for host in ("evil.example", "127.0.0.1:1", None)
    ),
    *(
        (DOWNLOAD, "{}", {"Origin": origin}, 403, "own page")
        for origin in ("http://evil.example", "null")
    ),
    *(
        (DOWNLOAD, "{}", {TOKEN_HEADER: token}, 403, "not the token")
        for token in (None, "wrong", "\xe9")
    ),
    (DOWNLOAD, TABLES % '{"width_mm": NaN, "length_mm": 1e999}', {}, 200, "is not a finite number"),
]


def test_malformed_requests_get_one_sentence(
    server: StudioServer, capfd: pytest.CaptureFixture[str]
) -> None:
    for path, body, headers, status, said in MALFORMED:
        reply = ask(
            server, "POST", path, body if isinstance(body, bytes) else body.encode(), **headers
        )
        assert (reply.status, set(reply.content)) == (
            status,
            {"issues" if status == 200 else "error"},
        ), (body, headers)
        assert said in json.dumps(reply.content), (body, headers)
        assert "Access-Control-Allow-Origin" not in reply.headers
    own = ask(
        server, "POST", DOWNLOAD, (TABLES % '{"x": 1}').encode(), Origin=f"http://{server.hosts[1]}"
    )
    assert "there is no such parameter" in json.dumps(own.content)
    wait_for_handlers()
    assert capfd.readouterr() == ("", "")


def test_checks_that_nobody_waits_for_are_given_up(
    server: StudioServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twenty pages ask and are closed; the next one is answered,
    though each answer would take a minute.
    """
    begun = threading.Event()

    def work(design: Design, still_wanted: StillWanted) -> dict[str, Any]:
        begun.set()
        for _ in range(6000):
            still_wanted()
            time.sleep(0.01)
        return {}

    monkeypatch.setitem(answers.ANSWERS, "checks", work)
    bodies = ((TABLES.replace('"a"', f'"{number}"') % "{}").encode() for number in range(20))
    asked = [send(server, "POST", "/api/checks", body) for body in bodies]
    assert begun.wait(20)
    for connection in asked:
        connection.close()
    assert post(server, "download/design", {}).headers["Content-Disposition"]
    wait_for_handlers()
    assert not server.worker._newest


def test_a_fault_of_an_answer_is_a_sentence_on_the_page_and_a_traceback_in_the_terminal(
    server: StudioServer, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(design: Design, still_wanted: StillWanted) -> dict[str, Any]:
        raise ZeroDivisionError("here")

    monkeypatch.setitem(answers.ANSWERS, "checks", fail)
    reply = post(server, "checks", {})
    assert reply.status == 500
    assert "This is a bug in fingertip." in reply.content["error"]
    wait_for_handlers()
    assert "ZeroDivisionError: here" in capfd.readouterr().err


# Worker: one job at a time, and of each client the newest one


class Gate:
    """Job that runs until it is let go, and asks then whether it is still wanted."""

    def __init__(self, result: str) -> None:
        self.started = threading.Event()
        self.go = threading.Event()
        self.result = result

    def __call__(self, still_wanted: StillWanted) -> str:
        self.started.set()
        assert self.go.wait(10)
        still_wanted()
        return self.result


def start(
    pool: ThreadPoolExecutor, worker: NewestWinsWorker, client: str, gate: Gate
) -> Future[str]:
    newest = worker._newest.get(client)
    future = pool.submit(worker.run, client, gate, never)
    while worker._newest.get(client) is newest:  # until it has joined the queue
        pass
    return future


def never() -> bool:
    return False


def test_newest_of_each_client_wins() -> None:
    worker = NewestWinsWorker()
    gates = {name: Gate(name) for name in ("a1", "b1", "a2", "a3")}
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
