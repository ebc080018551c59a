"""The fuzzer sees each kind of fault, and goes on where it was stopped.

`.ci/run` runs some hundred of its cases, `.ci/full` thousands, and `.ci/long` tens of thousands. What these find
becomes a test of its own elsewhere, by name.
"""

from __future__ import annotations

import hashlib
import io
import sqlite3
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.tools import require_tool
from tools.fuzz.cases import Case
from tools.fuzz.outcome import Outcome, find_faults
from tools.fuzz.promises import PROMISES, check_folder

CASE = Case("test", ("params", "--json"), promise="design", is_accepted=True)


@pytest.mark.parametrize(
    ("outcome", "fault"),
    [
        (Outcome(70, "", "error: fault", 0, 0.1), "traceback"),
        (Outcome(1, "{}", "Traceback (most recent call last)", 0, 0.1), "traceback"),
        (Outcome(1, "{}", "", 0, 0.1), "exit code"),
        (Outcome(-11, "", "", 0, 0.1), "exit code"),
        (Outcome(2, "", "", 0, 0.1), "silent"),
        (Outcome(2, "", "error: at most 3", 0, 0.1), "refused"),
        (Outcome(None, "", "", 0, 10.1), "hang"),
        (Outcome(2, "", "error: x", 2**31, 0.1), "memory"),
        (Outcome(2, "", "error: \x07", 0, 0.1), "control"),
        (Outcome(2, "", "error: " + "x" * 10_000, 0, 0.1), "length"),
        (Outcome(0, "[skin]\nwidth_mm = 1\n", "", 0, 0.1), "invalid"),
        (Outcome(0, '{"a": NaN}', "", 0, 0.1), "invalid"),
    ],
)
def test_each_fault_is_seen(tmp_path: Path, outcome: Outcome, fault: str) -> None:
    assert any(found.startswith(fault) for found in find_faults(CASE, outcome, tmp_path))


def _saved(save: Callable[[io.BytesIO], object]) -> bytes:
    file = io.BytesIO()
    save(file)
    return file.getvalue()


def _stl(triangles: list[tuple[int, ...]]) -> bytes:
    """Tetrahedron, or what is left of it."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
    records = np.zeros(len(triangles), [("numbers", "<f4", (4, 3)), ("end", "<u2")])
    records["numbers"][:, 1:] = corners[np.array(triangles)]
    return bytes(80) + len(triangles).to_bytes(4, "little") + records.tobytes()


def _threemf(item: str) -> bytes:
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in TETRAHEDRON)
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
    mesh = f"<mesh><vertices>{points}</vertices><triangles>{faces}</triangles></mesh>"
    text = f'<model><object id="1">{mesh}</object><build><item objectid="{item}"/></build></model>'
    return _saved(lambda file: zipfile.ZipFile(file, "w").writestr("3D/3dmodel.model", text) or None)


def _database(value: float) -> bytes:
    connection = sqlite3.connect(":memory:")
    connection.execute("CREATE TABLE rows (a REAL)")
    connection.execute("INSERT INTO rows VALUES (?)", (value,))
    connection.commit()
    return connection.serialize()


TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
PNG = [_saved(lambda file, n=n: Image.linear_gradient("L").resize((n, n)).save(file, "PNG")) for n in (9, 1)]
NETLIST = '(export (components (comp (ref "R1"))) (nets (net (code 1) (node (ref "{}") (pin 1)))))'
HASHED = '{{"files": {{"a.md": "{}"}}}}'
FILES: list[tuple[str, str | bytes, list[str | bytes]]] = [
    ("a.json", '{"a": 1.5}', ['{"a": NaN}', '{"a": 1e999}', '{"a": 1, "a": 2}', "{"]),
    ("manifest.json", HASHED.format(hashlib.sha256(b"1").hexdigest()), [HASHED.format("0" * 64)]),
    ("a.toml", "a = 1.5", ["a = inf", "a =", "[skin]\nwidth_mm = 1"]),
    ("a.csv", "time_s,a\n0,1\n1,2\n", ["time_s,a\n0,1\n0,2\n", "a,b\n1\n", "a\nnan\n", "a,a\n1,1\n", "time_s\n"]),
    ("a.npz", _saved(lambda file: np.savez(file, a=[1.0])), [_saved(lambda file: np.savez(file, a=[np.inf])), b"PK"]),
    ("a.sqlite", _database(1.0), [_database(float("inf")), b"x" * 4096]),
    ("a.png", PNG[0], [PNG[1], b""]),
    ("a.svg", '<svg viewBox="0 0 9 9"><rect x="0"/><path d="M 1 2"/></svg>',
     ['<svg viewBox="0 0 9 9"><rect x="0"/></svg>', '<svg viewBox="0 0 9 9"><rect x="0"/><path d="M nan 2"/></svg>',
      '<svg viewBox="0 0 9 9"><rect x="0"/><path d="M -1 2"/></svg>', "<svg>"]),
    ("a.pdf", "%PDF-1.4 /Type /Page /Count 1 %%EOF", ["%PDF-1.4 /Type /Page /Count 2 %%EOF", "%PDF-1.4"]),
    ("a.html", "<p id='a'>1<br></p>",
     ["<p>1", "<p></b></p>", "<p id='a'><i id='a'>1</i></p>", "<p>nan</p>", "<p></p>"]),
    ("a.stl", _stl(TETRAHEDRON), [_stl(TETRAHEDRON)[:-1], _stl(TETRAHEDRON[:3]), _stl([t[::-1] for t in TETRAHEDRON])]),
    ("a.3mf", _threemf("1"), [_threemf("2"), b"PK"]),
    ("a.step", "ISO-10303-21;\n#1 = A(1.);\nEND-ISO-10303-21;",
     ["ISO-10303-21;\n#1 = A(#2);\nEND-ISO-10303-21;", "ISO-10303-21;\n#1 = A(nan);\nEND-ISO-10303-21;", "#1 = A();"]),
    ("a.net", NETLIST.format("R1"), [NETLIST.format("R2"), NETLIST.format("R1")[:-1], NETLIST.format("R1") + ")"]),
    ("a.kicad_pcb", '(a "(" 1)', ['(a "(", nan)', '(a "b)', "(a) (b)"]),
    ("a.c", 'int a(void) { return "}"[0]; }', ["int a(void) {", "int a(void) { return inf; }", "int a(void) { b; }"]),
    ("a.md", "None of the 3 vents.\nNone.", ["a = nan mm", "None", "-inf", ""]),
]  # fmt: skip


@pytest.mark.parametrize(("name", "sound", "broken"), FILES, ids=[file[0] for file in FILES])
def test_each_promise_can_be_broken(tmp_path: Path, name: str, sound: str | bytes, broken: list[str | bytes]) -> None:
    if name == "a.c":
        require_tool("gcc", "apt-get install gcc")
    if name == "manifest.json":
        (tmp_path / "a.md").write_text("1")
    for content in (sound, *broken):
        (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
        assert bool(list(check_folder(tmp_path))) == (content is not sound), content
    kinds = {each.rpartition(".")[2] for each, *_ in FILES}
    tested = {promise for kind, promises in PROMISES.items() if kind[1:] in kinds for promise in promises}
    assert {promise for promises in PROMISES.values() for promise in promises} == tested, "every promise is tested"
