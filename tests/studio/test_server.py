"""Studio without a browser: parts, checks, refusals and downloads, and who is not let in."""

from __future__ import annotations

import base64
import copy
import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip import Design
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.check import Solids
from fingertip.cad.verification.verify import run_checks
from fingertip.foundation.errors import StudioError
from fingertip.models.parts import parts_by_name
from fingertip.studio.answers import DOWNLOADS, VIEW_TOLERANCE_MM
from fingertip.studio.server import StudioServer
from fingertip.tasks.build import build
from tests.conftest import run_fingertip
from tests.page.conftest import strip_elements
from tests.studio.conftest import ask, post


def change(tables: dict[str, Any], **values: object) -> dict[str, Any]:
    """Tables with other values; two underscores stand for the dot."""
    changed = copy.deepcopy(tables)
    for path, value in values.items():
        table, _, key = path.rpartition("__")
        (changed[table] if table else changed)[key] = value
    return changed


def test_parts_are_those_of_the_changed_design(
    server: StudioServer, tables: dict[str, Any]
) -> None:
    wider = change(tables, skin__width_mm=19)
    answer = post(server, "parts", wider).content
    design = Design.from_tables(wider)
    evaluator = MeshEvaluator(VIEW_TOLERANCE_MM)
    parts = {
        name: evaluator.mesh(part.solid(design))
        for name, part in parts_by_name(design).items()
        if not part.is_tool
    }
    shown = {item["name"]: item for item in answer["scene"]}
    assert [name for name, item in shown.items() if not item["bought"]] == list(parts)
    for name, mesh in parts.items():
        vertices = np.frombuffer(base64.b64decode(shown[name]["vertices"]), "<f4").reshape(-1, 3)
        assert np.allclose(vertices, mesh.vertices, atol=1e-5)
        assert shown[name]["scale"] == 1.0
    assert "sensor" in shown
    assert strip_elements(answer["boxes"]).startswith("boneskinmold palmarmold dorsalcoresensor")


@pytest.mark.second
def test_checks_are_those_of_the_design(server: StudioServer, tables: dict[str, Any]) -> None:
    answer = post(server, "checks", tables).content
    assert answer["passed"]
    design = Design.from_tables(tables)
    checks = [
        *run_checks(
            design, Solids.of(design, MeshEvaluator(VIEW_TOLERANCE_MM), parts_by_name(design))
        )
    ]
    assert answer["count"] == len(checks)
    assert {check.name.partition(".")[0] for check in checks} >= set(parts_by_name(design))
    assert "mold.creep" in strip_elements(answer["checks"])
    verdict = strip_elements(answer["verdict"])
    assert f"All {answer['count']} checks of the shape passed" in verdict
    assert "skin" in answer["moves"]["skin.width_mm"]
    weak = post(server, "checks", change(tables, strength__grip_force_n=150)).content
    assert weak["failed"] == ["bone.safety_factor.grip"]
    assert "1 of" in strip_elements(weak["verdict"])


def test_a_page_chooses_no_file_of_this_machine(
    server: StudioServer, tables: dict[str, Any]
) -> None:
    (issue,) = post(server, "parts", change(tables, bone__adapter_file="/etc/hostname")).content[
        "issues"
    ]
    assert issue["field"] == "bone.adapter_file"


def test_rules_answer_with_the_nearest_value_that_passes(
    server: StudioServer, tables: dict[str, Any]
) -> None:
    def judge(path: str, **values: object) -> Any:
        return post(server, "rules", change(tables, **values), field=path).content

    assert judge("skin.width_mm", skin__width_mm=18) == {}
    for value, passing in ((8, 16.9), (40, 23.1), ("x", 17)):
        answer = judge("skin.width_mm", skin__width_mm=value)
        (issue,) = answer["issues"]
        assert (issue["field"], answer["passing"]) == ("skin.width_mm", passing)
        assert issue["message"].endswith(
            "With the other parameters as they are, 16.9 to 23.1 mm pass."
        )
        assert judge("skin.width_mm", skin__width_mm=passing) == {}
    # No value of the parameter in hand helps: the remedies say which other does.
    others = judge("skin.length_mm", skin__width_mm=8)
    assert "passing" not in others
    assert any("skin.width_mm" in issue["field"] + issue["message"] for issue in others["issues"])
    assert (
        post(server, "bands", change(tables, skin__width_mm=8), field="skin.length_mm").content[
            "bands"
        ]
        == []
    )


@pytest.mark.full
def test_the_picture_of_the_pad_holds_the_figures_of_the_command(
    server: StudioServer, tables: dict[str, Any]
) -> None:
    drawn = post(server, "pad", change(tables, skin__crown_radius_mm=14)).content["pad"]
    found = json.loads(
        run_fingertip("pad", "fsr400", "--set", "skin.crown_radius_mm=14", "--json").stdout
    )
    shares = [(f"{row['share']:.4f}", f"{row['tilt_deg']:g}") for row in found["tilts"]]
    assert re.findall(r"<title>share (\S+) at a tilt of (\S+)°</title>", drawn) == shares
    assert f"Rolled by 10 degrees it gets {found['rolled_share']:.0%}" in drawn


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("skin__width_mm", "", "'' is not a number; write a number in mm"),
        ("skin__width_mm", "17 mm", "without its unit"),
        ("skin__width_mm", None, "is not a number"),
        ("skin__width_mm", float("nan"), "not a finite number"),
        ("detector__window_samples", 60.5, "60.5 is not a whole number"),
        ("bone__interface", "<script>", "'<script>' is not known"),
        ("name", "../../etc", "cannot name a folder"),
        ("skin__colour", 3, "there is no such parameter"),
        ("skin", [], "is not a table"),
    ],
)
def test_a_wrong_value_is_refused_at_its_field(
    server: StudioServer, tables: dict[str, Any], path: str, value: object, said: str
) -> None:
    issues = post(server, "parts", change(tables, **{path: value})).content["issues"]
    assert issues[0]["field"] == path.replace("__", ".")
    assert said in issues[0]["message"]


@pytest.mark.full
def test_downloads_and_checks_are_those_of_a_build(
    server: StudioServer, tables: dict[str, Any], tmp_path: Path
) -> None:
    changed = change(tables, name="mine", skin__width_mm=18, printer__scale_percent=100.5)
    report = build(Design.from_tables(changed), tmp_path, formats=["stl", "3mf"]).report()
    answer = post(server, "all-checks", changed).content
    assert (answer["count"], answer["passed"]) == (len(report["checks"]), True)
    replies = {name: post(server, f"download/{name}", changed) for name in DOWNLOADS}
    names = {
        name: reply.headers["Content-Disposition"].partition('filename="')[2][:-1]
        for name, reply in replies.items()
    }
    assert names == {
        "design": "mine.toml",
        "stl": "mine_stl.zip",
        "plate": "mine_plate_fdm.3mf",
        "picture": "mine.png",
    }
    assert replies["design"].data == (tmp_path / "design.toml").read_bytes()
    assert replies["plate"].data == (tmp_path / "print" / "plate_fdm.3mf").read_bytes()
    with zipfile.ZipFile(io.BytesIO(replies["stl"].data)) as archive:
        built = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.stl")} | {
            "design.toml"
        }
        assert set(archive.namelist()) == built
        for name in built:
            assert archive.read(name) == (tmp_path / name).read_bytes()
    assert post(server, "download/stl", changed).data == replies["stl"].data


def test_several_plates_come_in_one_zip_file(server: StudioServer, tables: dict[str, Any]) -> None:
    reply = post(
        server, "download/plate", change(tables, printer__bed_x_mm=70, printer__bed_y_mm=70)
    )
    assert reply.headers["Content-Type"] == "application/zip", reply.data[:200]
    with zipfile.ZipFile(io.BytesIO(reply.data)) as archive:
        assert archive.namelist()[:2] == ["plate_fdm_1.3mf", "plate_fdm_2.3mf"]


def test_page_needs_the_token_and_the_host(server: StudioServer) -> None:
    path = server.url.partition(str(server.server_port))[2]
    page = ask(server, "GET", path)
    assert page.status == 200
    assert server.token in page.data.decode()
    assert server.socket.getsockname()[0] == "127.0.0.1", "it listens on this machine alone"
    assert server.socket.getsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR), (
        "a server that ended leaves its port"
    )
    assert page.headers["Cache-Control"] == "no-store"
    assert "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]
    assert ask(server, "GET", path, Host=server.hosts[1]).status == 200
    for other in ("/", "/?token=", "/?token=wrong", f"/?token={server.token}x"):
        locked = ask(server, "GET", other)
        assert locked.status == 403
        assert server.token not in locked.data.decode()
        assert "terminal" in locked.data.decode()
    assert ask(server, "GET", path, Host="evil.example").status == 403
    assert [ask(server, "GET", path).status for path in ("/etc/passwd", "*")] == [404, 404]
    # No other page may ask whether it may ask.
    assert ask(server, "OPTIONS", "/api/parts").status == 501


def test_a_port_that_cannot_be_used_is_one_sentence(server: StudioServer) -> None:
    for port in (-1, 65536):
        done = run_fingertip("studio", "--port", port, "--no-browser")
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert f"{port} is no port" in done.stderr
    done = run_fingertip("studio", "fsr400", "--port", server.server_port, "--no-browser")
    assert done.returncode == 2
    assert done.stderr == (
        f"error: --port: {server.server_port} is in use, perhaps by another studio; choose "
        "another with --port, or "
        "--port 0 for any free one.\n"
    )
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with pytest.raises(StudioError, match="is in use"):
            StudioServer(server.design, other.getsockname()[1])


@pytest.mark.parametrize("arguments", [pytest.param(["--no-browser"], marks=pytest.mark.full), []])
def test_ends_cleanly_at_ctrl_c(arguments: list[str], tmp_path: Path) -> None:
    """Without a browser on the machine, the command says so in
    one sentence and serves all the same.
    """
    environment = {**os.environ, "PATH": str(tmp_path), "BROWSER": "none-of-these"}
    environment.pop("DISPLAY", None)
    environment.pop("WAYLAND_DISPLAY", None)
    command = [sys.executable, "-m", "fingertip", "studio", "fsr400", "--port", "0", *arguments]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout
    assert process.stderr
    try:
        url = process.stdout.readline()
        assert re.fullmatch(r"studio: http://127\.0\.0\.1:\d+/\?token=[\w-]{32}\n", url)
        said = [process.stderr.readline()]
        if not arguments:
            said.append(process.stderr.readline())
            assert (
                said[1] == "no browser was found; open the address above in one of this machine\n"
            )
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 0
    assert out == ""
    assert err == "studio ended\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.second
def test_a_fit_keeps_what_was_given_and_moves_what_follows(
    server: StudioServer, tables: dict[str, Any]
) -> None:
    narrow = change(tables, skin__width_mm=16)
    assert post(server, "rules", narrow, field="skin.width_mm").content["issues"]
    moves = post(server, "fit", narrow, field="skin.width_mm").content["fitted"]
    assert moves
    values = {move["name"].replace(".", "__"): move["after"] for move in moves}
    assert "skin__width_mm" not in values
    assert post(server, "rules", change(narrow, **values), field="skin.width_mm").content == {}
    assert post(server, "fit", tables, field="").content == {"fitted": []}
