"""Promises on files: each kind is read again by something that shares no code with what wrote it.

A promise is a function of a path. It returns nothing, and raises whatever it likes if the file
breaks it.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import re
import shutil
import sqlite3
import subprocess
import tomllib
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.design import Design

_NO_NUMBER = re.compile(
    r"(?<![\w.])[-+]?(?:nan|inf|infinity|NaN|Infinity|None)(?![\w-]| of\b|\.$)", re.MULTILINE
)
_VOID = frozenset(
    {"area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "wbr"}
)
_FIRST_POINT = ("d", "points", "x y", "cx cy", "x1 y1")
"""Attributes of drawn elements that begin with the coordinates of a point."""


def check_folder(folder: Path) -> Iterator[str]:
    """Yield the broken promises of all files below a folder."""
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        for promise in PROMISES.get(path.suffix or path.name, ()) or (is_expected,):
            try:
                promise(path)
            except Exception as error:
                detail = f"{type(error).__name__}: {error}"
                yield f"{promise.__name__}: {path.relative_to(folder).as_posix()}: {detail[:400]}"


def is_expected(path: Path) -> None:
    """A file of a kind that has no promise."""
    raise AssertionError(f"nothing reads {path.suffix} again")


def has_only_numbers(path: Path) -> None:
    """Text names no value that is not finite, and no value of Python's that is missing."""
    text = path.read_text(encoding="utf-8")
    assert text.strip(), "is empty"
    if path.name == "slip_detector.c":  # its comments explain what it does with NaN
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)

    refuse_no_numbers(text)


def refuse_no_numbers(text: str) -> None:
    """Raise an exception at the first number that is none."""
    found = _NO_NUMBER.search(text)
    if found:
        raise AssertionError(f"{text[max(0, found.start() - 60) : found.end() + 20]!r}")


def read_json(text: str) -> Any:
    """Read JSON strictly: finite numbers, and no name twice."""

    def finite(word: str) -> float:
        assert math.isfinite(float(word)), word
        return float(word)

    def table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        assert len(dict(pairs)) == len(pairs), f"a name stands twice: {[name for name, _ in pairs]}"
        return dict(pairs)

    return json.loads(text, parse_constant=finite, parse_float=finite, object_pairs_hook=table)


def is_json(path: Path) -> None:
    """JSON is strict; a manifest lists files that have the bytes it states."""
    data = read_json(path.read_text(encoding="utf-8"))
    if path.name == "manifest.json":
        for name, digest in data["files"].items():
            assert hashlib.sha256((path.parent / name).read_bytes()).hexdigest() == digest, name


def is_toml(path: Path) -> None:
    """TOML is read by tomllib, and a design is accepted again."""
    text = path.read_text(encoding="utf-8")
    tables = tomllib.loads(text)
    if "readings" not in path.name:  # a template asks for what it does not know
        refuse_no_numbers(text)
    if "skin" in tables:
        Design.load(path)


def is_table(path: Path) -> None:
    """CSV has rows of equal length; times increase."""
    with path.open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file, strict=True)

    assert len(set(head)) == len(head), f"columns {head}"
    assert all(len(row) == len(head) for row in rows), "rows of different lengths"
    if head[0] == "time_s":
        times = np.array([float(row[0]) for row in rows])
        assert len(times), "no samples"
        assert (np.diff(times) > 0.0).all(), "times do not increase"


def is_trace(path: Path) -> None:
    """Arrays have samples, all of them finite."""
    with np.load(path, allow_pickle=False) as arrays:
        for name, array in arrays.items():
            assert array.dtype.kind in "US" or (array.size and np.isfinite(array).all()), name


def is_database(path: Path) -> None:
    """Database is sound, and its numbers are finite."""
    connection = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    for row in connection.execute("SELECT * FROM rows"):
        assert all(math.isfinite(value) for value in row if isinstance(value, float)), row

    connection.close()


def is_figure(path: Path) -> None:
    """Picture has more than one colour."""
    from PIL import Image

    with Image.open(path) as image:
        ranges = image.convert("RGB").getextrema()

    assert any(low != high for low, high in ranges), f"one colour: {ranges}"  # type: ignore[misc]


def is_drawing(path: Path) -> None:
    """SVG has a drawn element with a point inside its view, beside
    a first one that may be its background.
    """
    from lxml import etree

    root = etree.parse(path).getroot()
    left, top, width, height = map(float, root.get("viewBox").split())
    drawn = 0

    for element in root.iter(
        "{*}path", "{*}polyline", "{*}polygon", "{*}line", "{*}rect", "{*}circle", "{*}text"
    ):
        for names in _FIRST_POINT:
            if element.get(names.split()[0]) is not None:
                text = " ".join(element.get(name, "0") for name in names.split())
                x, y = map(float, re.findall(r"-?\d[\d.]*(?:e-?\d+)?", text)[:2])
                drawn += left <= x <= left + width and top <= y <= top + height

    assert drawn > 1, f"{drawn} elements within the view"


def is_document(path: Path) -> None:
    """PDF begins and ends as one, and has the pages that it counts."""
    data = path.read_bytes()
    assert data.startswith(b"%PDF-"), data[:20]
    assert data.rstrip().endswith(b"%%EOF"), data[-20:]
    pages = re.findall(rb"/Type\s*/Page\b(?!s)", data)
    (count,) = re.findall(rb"/Count\s+(\d+)", data)
    assert len(pages) == int(count) > 0, f"{len(pages)} pages of {count!r}"


class _Page(HTMLParser):
    """Reader of a page that follows its elements and gathers the text that is shown."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.names: list[str] = []
        self.shown: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Follow an element's beginning."""
        self.names += [value or "" for name, value in attrs if name == "id"]
        if tag not in _VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Follow an element without content."""

    def handle_endtag(self, tag: str) -> None:
        """Follow an element's end."""
        assert self.open[-1:] == [tag], f"</{tag}> at {self.getpos()}"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        """Gather shown text."""
        if self.open and self.open[-1] not in ("script", "style"):
            self.shown.append(data)


def is_page(path: Path) -> None:
    """HTML closes every element, names none twice, and shows numbers."""
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    page.close()
    assert not page.open, f"not closed: {page.open}"
    assert len(set(page.names)) == len(page.names), "an id stands twice"
    assert page.shown, "no text"
    refuse_no_numbers(" ".join(page.shown))


def check_closed(corners: np.ndarray) -> None:
    """Check that triangles enclose a volume: finite, and each edge once in either direction."""
    assert len(corners) > 3, f"{len(corners)} triangles"
    assert np.isfinite(corners).all(), "a corner is not finite"
    flat = corners.reshape(-1, 3)
    _, index = np.unique(flat, axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3).astype(np.int64)
    edges = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    keys = edges[:, 0] << 32 | edges[:, 1]
    back = edges[:, 1] << 32 | edges[:, 0]
    assert len(np.unique(keys)) == len(keys), "an edge is used twice"
    assert np.array_equal(np.sort(keys), np.sort(back)), "an edge is open"
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume > 0.0, f"a volume of {volume} mm3"


def is_closed_stl(path: Path) -> None:
    """Binary STL is as long as it says, and closed."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    assert len(data) == 84 + 50 * count, f"{len(data)} bytes for {count} triangles"
    records = np.frombuffer(data, np.dtype([("numbers", "<f4", (4, 3)), ("end", "<u2")]), offset=84)
    assert np.isfinite(records["numbers"]).all(), "a normal is not finite"
    check_closed(records["numbers"][:, 1:].astype(float))


def is_closed_3mf(path: Path) -> None:
    """3MF is a sound archive of well-formed XML, whose items exist and whose meshes are closed."""
    from lxml import etree

    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        roots = {
            name: etree.fromstring(archive.read(name))
            for name in archive.namelist()
            if name.endswith("l")
        }

    model = roots["3D/3dmodel.model"]
    objects = {element.get("id") for element in model.iter("{*}object")}
    items = [element.get("objectid") for element in model.iter("{*}item")]
    assert set() < set(items) <= objects, f"items {items} of objects {objects}"

    for mesh in model.iter("{*}mesh"):
        points = np.array(
            [[float(vertex.get(axis)) for axis in "xyz"] for vertex in mesh.iter("{*}vertex")]
        )
        faces = [
            [int(face.get(corner)) for corner in ("v1", "v2", "v3")]
            for face in mesh.iter("{*}triangle")
        ]
        assert min(map(min, faces)) >= 0
        check_closed(points[np.array(faces)])


def is_step(path: Path) -> None:
    """STEP begins and ends as one, and defines every entity that it uses."""
    text = path.read_text(encoding="ascii")
    assert text.startswith("ISO-10303-21;"), text[:40]
    assert text.rstrip().endswith("END-ISO-10303-21;"), text[-40:]
    defined = re.findall(r"^#(\d+)\s*=", text, re.MULTILINE)
    assert len(set(defined)) == len(defined) > 0, "an entity is defined twice"
    assert set(re.findall(r"#(\d+)", text)) == set(defined), "an entity is used and not defined"
    refuse_no_numbers(re.sub(r"'[^']*'", "", text))


def read_expression(text: str) -> list[Any]:
    """Read one s-expression as nested lists of words."""
    stack: list[list[Any]] = [[]]
    for quoted, mark, word in re.findall(r'("(?:[^"\\]|\\.)*")|([()"])|([^\s()"]+)', text):
        assert mark != '"', "a text is not closed"
        if mark == "(":
            stack.append([])
        elif mark == ")":
            assert len(stack) > 1, "a list is closed twice"
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(word or quoted[1:-1])

    assert len(stack) == 1 == len(stack[0]), "a list is not closed, or stands beside another"
    return list(stack[0][0])


def is_kicad(path: Path) -> None:
    """File of KiCad is one s-expression; the nets of a netlist join components that it has."""
    tree = read_expression(path.read_text(encoding="utf-8"))
    if path.suffix != ".net":
        return

    sections: Mapping[str, list[Any]] = {section[0]: section[1:] for section in tree[1:]}
    named = {dict(part[1:3])["ref"] for part in sections["components"]}
    joined = {
        dict(node[1:3])["ref"] for net in sections["nets"] for node in net if node[0] == "node"
    }
    assert set() < joined <= named, f"no nets, or no components {joined - named}"


def is_c(path: Path) -> None:
    """Source in C has balanced brackets, and a compiler accepts it."""
    text = re.sub(
        r'/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"|\'(?:\\.|[^\'])\'',
        "",
        path.read_text(),
        flags=re.DOTALL,
    )
    for pair in ("()", "[]", "{}"):
        assert text.count(pair[0]) == text.count(pair[1]), pair

    if path.suffix == ".c" and shutil.which("gcc"):
        command = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", str(path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


_TEXT: Iterable[Callable[[Path], None]] = (has_only_numbers,)
PROMISES: Mapping[str, tuple[Callable[[Path], None], ...]] = {
    ".json": (is_json,),
    ".kicad_pro": (is_json,),
    ".toml": (is_toml,),
    ".csv": (*_TEXT, is_table),
    ".npz": (is_trace,),
    ".sqlite": (is_database,),
    ".png": (is_figure,),
    ".svg": (*_TEXT, is_drawing),
    ".pdf": (is_document,),
    ".html": (is_page,),
    ".stl": (is_closed_stl,),
    ".3mf": (is_closed_3mf,),
    ".step": (is_step,),
    ".net": (*_TEXT, is_kicad),
    ".kicad_sch": (*_TEXT, is_kicad),
    ".kicad_pcb": (*_TEXT, is_kicad),
    ".c": (*_TEXT, is_c),
    ".h": (*_TEXT, is_c),
    ".ino": (*_TEXT, is_c),
    ".cir": (*_TEXT,),
    ".md": (*_TEXT,),
    ".properties": (*_TEXT,),
    ".txt": (*_TEXT,),
    ".urdf": (*_TEXT,),
    ".xml": (*_TEXT,),
    ".gitattributes": (*_TEXT,),
}
"""Promises of each kind of file by the end of its name."""
