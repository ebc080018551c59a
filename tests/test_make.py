"""`fingertip make`: everything of a design in one folder, as the single commands write it."""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path

import pytest

from fingertip import Design, Made, board_values, make
from fingertip.cad.files.step_process import StepProcess
from fingertip.catalogues.output_files import ACCEPTANCE, PART_FILES
from fingertip.documents.acceptance import acceptance_sheet, render_acceptance
from fingertip.foundation import extras
from fingertip.foundation.errors import GeometryError, Issue, OutputError
from fingertip.foundation.files import ZIP_DATE, write_zip
from fingertip.foundation.output_set import SetWriter, is_packed_set
from fingertip.pictures.drawing.draw import file_names
from fingertip.tasks.board_files import write_board
from fingertip.tasks.build import build
from fingertip.tasks.manifest_comparison import verify_sets
from tests.conftest import run_fingertip


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("make") / "finger"
    design = Design.load("fsr400")
    result = make(design, folder, formats=["stl"])
    assert result.parts.passed
    assert result.detection.detection.intervals
    assert result.drawings == ()
    assert {path.name for path in result.signal} >= {"trace.csv", "detection.json"}
    assert board_values(design).variant == "precision"
    return folder


@pytest.mark.full
def test_each_set_is_the_one_of_its_own_command(made: Path, tmp_path: Path) -> None:
    """Parts and board have the bytes that `build` and `board` write; the trace is that of
    `simulate`.

    Only `make` has a detection, and so an acceptance sheet beside the parts.
    """
    design = Design.load("fsr400")
    build(design, tmp_path / "single", formats=["stl"], pictures=True)
    write_board(design, tmp_path / "single" / "board", bring_up=True)
    page = render_acceptance(acceptance_sheet(design))
    PART_FILES.writer(design, tmp_path / "single").add({ACCEPTANCE: page.encode()})
    trace = tmp_path / "trace.csv"
    assert run_fingertip("simulate", "fsr400", "--out", trace).returncode == 0
    found = files_below(made)
    assert found.pop("index.html")  # tests/page compares it
    signal = {name: data for name, data in found.items() if name.startswith("signal/")}
    single = files_below(tmp_path / "single")
    manifest, single_manifest = (
        json.loads(files.pop("manifest.json")) for files in (found, single)
    )
    assert manifest["files"].pop("index.html")
    assert manifest == single_manifest
    assert {name: data for name, data in found.items() if name not in signal} == single
    # The trial is that of `simulate`, with the board's filtered signal beside it.
    rows = [line.rsplit(",", 1)[0] for line in signal["signal/trace.csv"].decode().splitlines()]
    assert rows == trace.read_text().splitlines()
    signal_trace = made / "signal" / "trace.csv"
    assert signal_trace.read_text().startswith("time_s,voltage_v,force_n,slip,sampled_filtered_v\n")
    detected = json.loads(
        run_fingertip(
            "detect", signal_trace, "--design", "fsr400", "--detector", "fast", "--json"
        ).stdout
    )
    assert json.loads(signal["signal/detection.json"])["intervals"] == detected["intervals"]
    manifests = {path.parent.relative_to(made).as_posix() for path in made.rglob("manifest.json")}
    assert manifests >= {".", "print", "steps", "board", "signal"}
    assert verify_sets(made) == (
        len(files_below(made)) - len([*made.rglob(".gitattributes")]) - len(manifests),
        [],
    )


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("name", "design"),
    [
        ("bone.stl", "fsr400"),
        ("board/bom.csv", "fsr400"),
        ("signal/trace.csv", "fsr400"),
        ("firmware/slip_lamp/slip_lamp.ino", "first_finger"),
        *(
            pytest.param(name, "fsr400", marks=pytest.mark.full)
            for name in ("print/bone.stl", "steps/01-print.png")
        ),
    ],
)
def test_own_file_in_any_set_is_found_before_anything_is_written(
    tmp_path: Path, name: str, design: str
) -> None:
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).write_bytes(b"mine")
    with pytest.raises(OutputError, match="was not written by fingertip"):
        make(Design.load(design), tmp_path, formats=["stl"])
    assert files_below(tmp_path) == {name: b"mine"}


@pytest.mark.full
def test_step_files_and_drawings_are_added_to_what_can_be_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = Design.load("fsr400")
    messages = list[str]()
    usable: list[Made] = []

    def look(made: Made) -> None:
        usable.append(made)
        assert made.parts.passed
        assert verify_sets(tmp_path / "a")[1] == []
        names = {path.name for path in (tmp_path / "a").iterdir()}
        assert {"bone.3mf", "casting.md", "report.json", "index.html", "board", "signal"} <= names
        assert not [name for name in names if name.endswith(".step") or "drawing" in name]

    made = make(
        design,
        tmp_path / "a",
        formats=["stl", "3mf", "step"],
        progress=messages.append,
        when_usable=look,
    )
    assert made.drawings == tuple(tmp_path / "a" / name for name in file_names(design))
    assert all(path.is_file() for path in made.drawings)
    assert verify_sets(tmp_path / "a")[1] == []
    report = json.loads((tmp_path / "a/report.json").read_text())
    assert report == json.loads(json.dumps(made.parts.report()))
    assert len(made.parts.checks) > len(usable[0].parts.checks)
    assert "drawing.pdf" in (tmp_path / "a/index.html").read_text()

    monkeypatch.setattr(extras, "is_installed", lambda module: module != "reportlab")
    made = make(design, tmp_path / "b", formats=["stl", "step"], progress=messages.append)
    assert made.drawings == ()
    assert [message for message in messages if "left out" in message] == [
        f"left out: drawings; {extras.install_command('reportlab')} adds them"
    ]


@pytest.mark.full
def test_what_can_be_used_stays_where_the_kernel_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "fake").mkdir()
    (tmp_path / "fake/OCP.py").write_text("import time\ntime.sleep(600)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "fake"))  # of a new process
    monkeypatch.syspath_prepend(str(tmp_path / "fake"))  # of a copy of this one
    monkeypatch.setattr(StepProcess.result, "__defaults__", (0.1,))
    with pytest.raises(GeometryError, match=r"still loading Open CASCADE after 0\.1 s"):
        make(Design.load("fsr400"), tmp_path / "a")

    assert verify_sets(tmp_path / "a")[1] == []
    assert (tmp_path / "a/index.html").is_file()
    assert not list((tmp_path / "a").glob("*.step"))


@pytest.mark.full
def test_command_prints_where_everything_is(tmp_path: Path) -> None:
    run = run_fingertip(
        "make", "fsr400", "--formats", "stl", "--json", "--quiet", PWD=str(tmp_path)
    )
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert data["folder"] == "out/fsr400"
    assert all((tmp_path / name).is_file() for name in (*data["board"], *data["signal"]))
    assert data["parts"]["passed"]
    assert data["detection"]["intervals"]


def test_a_folder_becomes_one_archive_without_dates_and_links(tmp_path: Path) -> None:
    folder = tmp_path / "finger"
    (folder / "print").mkdir(parents=True)
    (folder / "print/plate.3mf").write_bytes(b"1")
    (folder / "link").symlink_to("print/plate.3mf")
    inside = folder / "all.zip"
    beside = tmp_path / "all.zip"
    write_zip(beside, folder)
    os.utime(folder / "print/plate.3mf", (0, 0))
    for _ in range(2):
        write_zip(inside, folder)
        assert inside.read_bytes() == beside.read_bytes()
    assert zipfile.ZipFile(inside).namelist() == ["finger/print/plate.3mf"]


def write_members(
    path: Path, members: dict[str, bytes], date: tuple[int, int, int, int, int, int] = ZIP_DATE
) -> None:
    with zipfile.ZipFile(path, "a") as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name, date), data)


@pytest.mark.every_case
@pytest.mark.parametrize(
    "case", ["of somebody else", "without manifest", "two folders", "a file added", "no ZIP", "cut"]
)
def test_an_archive_is_fingertips_only_if_it_is_one_dateless_folder_with_a_manifest(
    case: str, tmp_path: Path
) -> None:
    folder = tmp_path / "finger"
    file = tmp_path / "own.zip"
    SetWriter(folder, "parts", "finger", "now").write({"bone.stl": b"bone"})
    write_zip(file, folder)
    assert is_packed_set(file)

    manifest = (folder / "manifest.json").read_bytes()
    if case == "a file added":
        write_members(file, {"finger/notes.txt": b"mine"}, (2026, 1, 1, 0, 0, 0))
    elif case == "two folders":
        write_members(file, {"notes/manifest.json": manifest})
    elif case == "cut":
        file.write_bytes(file.read_bytes()[:-30])
    elif case == "no ZIP":
        file.write_bytes(b"notes")
    else:
        file.unlink()
        others = (
            {"finger/manifest.json": b"{}"}
            if case == "of somebody else"
            else {"finger/manifest.txt": manifest}
        )
        write_members(file, others)
    assert not is_packed_set(file)


@pytest.mark.parametrize("design", ["fsr400", "adult_hand"])
def test_an_archive_of_somebody_else_is_refused_before_work_and_one_of_make_is_replaced(
    design: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def begin(*_: object, **__: object) -> None:
        raise OutputError(Issue("work", "was begun."))

    for task in ("fingertip.tasks.make.make", "fingertip.tasks.make_set.make_set"):
        monkeypatch.setattr(task, begin)
    SetWriter(tmp_path / "finger", "parts", "finger", "now").write({"bone.stl": b"bone"})
    write_zip(tmp_path / "made.zip", tmp_path / "finger")
    (tmp_path / "own.zip").write_bytes(b"of somebody else")
    (tmp_path / "link.zip").symlink_to("made.zip")

    def run(*words: str) -> str:
        done = run_fingertip("make", design, "--quiet", *words, PWD=str(tmp_path))
        assert done.returncode == 2
        return done.stderr

    begun = "error: work: was begun.\n"
    for name in ("own.zip", "link.zip"):
        said = (
            "exists and is not overwritten; choose another file with --zip, or add --force to "
            "overwrite it."
        )
        assert run("--zip", name) == f"error: {name}: {said}\n"
        assert run("--zip", name, "--force") == begun
    assert run("--zip", "made.zip") == run("--zip", "another.zip") == begun
    assert (tmp_path / "own.zip").read_bytes() == b"of somebody else"
