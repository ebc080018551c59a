"""Files and folders that a command is asked to write: each option
refuses before any work what cannot be written.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from fingertip.catalogues.output_files import PART_FILES
from fingertip.cli import app, main
from fingertip.cli.help_page import metavar
from fingertip.cli.options import find_file_issues
from fingertip.design import Design
from tests.conftest import run_fingertip

FILES = (
    ("board", "--bode", ".csv", "fingertip.tasks.board_files.write_board"),
    ("sweep board", "--csv", ".csv", "fingertip.sweep.run.compute_rows"),
    ("picture fsr400", "--out", ".png", "fingertip.pictures.design_picture.draw"),
    ("sheet fsr400", "--out", ".md", "fingertip.casting.sheet.casting_sheet"),
    ("acceptance fsr400", "--out", ".md", "fingertip.documents.acceptance.acceptance_sheet"),
    ("check fsr400", "--junit", ".xml", "fingertip.cad.verification.verify.verify"),
    ("check fsr400", "--sarif", ".sarif", "fingertip.cad.verification.verify.verify"),
    ("make fsr400", "--zip", ".zip", "fingertip.tasks.build.verify"),
    ("simulate", "--out", ".csv", "fingertip.sim.simulation.Simulation.write"),
    ("simulate", "--plot", ".png", "fingertip.sim.simulation.Simulation.run"),
    ("detect trace.csv", "--plot", ".png", "fingertip.detection.recordings.detect_file"),
    ("new tip", "--out", ".toml", "fingertip.foundation.files.write_file"),
    (
        "calibrate printer fsr400 --half-thickness-mm 10.0",
        "--out",
        ".toml",
        "fingertip.foundation.files.write_file",
    ),
    (
        "calibrate sensor weighings.csv",
        "--out",
        ".toml",
        "fingertip.calibration.sensor.calibrate_sensor",
    ),
)
"""Words of a command, its option that names a file to write, a suffix
that is written, and what must not be called.
"""
FOLDERS = (
    ("build fsr400", "fingertip.tasks.build.verify"),
    ("make fsr400", "fingertip.tasks.build.verify"),
    ("board", "fingertip.foundation.output_set.SetWriter._write"),
    ("compare fsr400 fsr402", "fingertip.tasks.versions.make"),
    ("firmware fsr400", "fingertip.foundation.output_set.SetWriter._write"),
    ("robot fsr400", "fingertip.tasks.robot_files.build_finger"),
    ("validate", "fingertip.lab.validation.validate"),
    ("drawing fsr400", "fingertip.tasks.views.draw_files"),
    ("page fsr400", "fingertip.tasks.views.read_sources"),
    ("accuracy", "fingertip.lab.accuracy.measure.measure_accuracy"),
    ("sweep board", "fingertip.sweep.run.compute_rows"),
    ("record --port /dev/null", "fingertip.recorded_trials.record.Recorder.run"),
)
"""Words of a command whose --out is a folder, and what must not be called."""
READ = {"--design", "--floors", "--hand", "--own", "--from"}
"""Options that name a file to read."""


def fail(*arguments: object, **options: object) -> None:
    raise AssertionError("work was begun")


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    """Find modules that were imported while `fail` stood in for what
    they take from another: they would keep it.
    """
    yield
    modules = [
        module
        for name, module in sys.modules.items()
        if name.startswith(("fingertip", "benchmarks"))
    ]
    kept = [
        module.__name__
        for module in modules
        if any(value is fail for value in vars(module).values())
    ]
    assert not kept, "replace the function in the module that uses it"


def list_path_options(group: Any, words: tuple[str, ...] = ()) -> Iterator[tuple[str, str]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from list_path_options(command, (*words, name))
        else:
            for parameter in command.params:
                if parameter.param_type_name == "option" and metavar(parameter).startswith(
                    ("PATH", "FILE")
                ):
                    yield " ".join((*words, name)), max(parameter.opts, key=len)


def test_every_option_that_names_a_file_or_folder_is_listed_here() -> None:
    listed = [(words, option) for words, option, *_ in FILES] + [
        (words, "--out") for words, _ in FOLDERS
    ]
    found = [
        option for option in list_path_options(typer.main.get_command(app)) if option[1] not in READ
    ]
    commands = [(re.match(r"(calibrate) \w+|\w+", words)[0], option) for words, option in listed]  # type: ignore[index]
    assert sorted(commands) == sorted(found)


@pytest.mark.every_case
@pytest.mark.parametrize(("words", "option", "suffix", "work"), FILES)
def test_a_file_that_cannot_be_written_is_refused_before_work(
    words: str, option: str, suffix: str, work: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work, fail)
    for name, said in (
        (tmp_path, f"{tmp_path}: is a folder; choose another file with {option}."),
        (
            f"x{suffix}.txt",
            f"{option}: 'x{suffix}.txt' is of no format that is written; end it in {suffix}",
        ),
        (
            f"/proc/x{suffix}",
            f"/proc/x{suffix}: cannot be written (No such file or directory); choose another file",
        ),
    ):
        done = run_fingertip(*words.split(), option, name, PWD=str(tmp_path))
        assert done.returncode == 2
        assert said in done.stderr
    assert not any(tmp_path.iterdir())


@pytest.mark.every_case
@pytest.mark.parametrize(("words", "work"), FOLDERS)
def test_a_folder_that_cannot_be_written_is_refused_before_work(
    words: str, work: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work, fail)
    done = run_fingertip(*words.split(), "--out", "/proc/x/y", PWD=str(tmp_path))
    assert done.returncode == 2
    assert (
        "/proc/x/y: cannot be written (No such file or directory); choose another folder with --out"
        in done.stderr
    )
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "option", "suffix", "work"), [case for case in FILES if " fsr400" in case[0]][:3]
)
def test_a_file_beside_the_parts_of_another_design_is_refused_before_work(
    words: str, option: str, suffix: str, work: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work, fail)
    PART_FILES.writer(Design(), tmp_path / "out" / "fsr400").write({"bone.stl": b""})
    done = run_fingertip(*words.split(), "--set", "skin.width_mm=18", PWD=str(tmp_path))
    assert done.returncode == 2
    assert "out/fsr400: holds the parts of another design, or of other parameters" in done.stderr


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("folder.toml", "folder.toml: is a folder; choose another file with --out."),
        (".toml", "--out: '.toml' is of no format that is written; end it in .toml or .TXT."),
        (
            "mine.toml/x.toml",
            "mine.toml/x.toml: cannot be written (Not a directory); choose another file with "
            "--out.",
        ),
        (
            "a/../" + 300 * "x" + ".toml",
            "cannot be written (File name too long); choose another file with --out.",
        ),
        ("loop.toml/x.toml", "loop.toml/x.toml: cannot be written ("),
        ("./mine.toml", "--out: mine.toml is an input of this command; give another name."),
        (
            "gone.toml",
            "gone.toml: exists and is not overwritten; choose another file with --out, or pay.",
        ),
        ("a/b/c.TOML", None),
    ],
)
def test_each_fault_of_a_file_is_named(
    name: str, said: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder.toml").mkdir()
    Path("mine.toml").touch()
    Path("gone.toml").symlink_to("nowhere")
    Path("loop.toml").symlink_to("loop.toml")
    before = sorted(tmp_path.iterdir())
    inputs = (None, Path("nothing.toml"), Path("mine.toml"))
    issues = [*find_file_issues("--out", Path(name), ".toml", ".TXT", inputs=inputs, kept="pay")]
    assert len(issues) == (said is not None)
    assert not said or said in issues[0].typed
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("words", [("board", "--out", ""), ("board", "--out="), ("build", "")])
def test_an_empty_word_names_no_folder(
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A variable of the shell that is not set once wrote a board
    among the files of the current folder.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["fingertip", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    name = "--out" if "board" in words else "argument"
    assert capsys.readouterr().err.startswith(
        f"error: {name}: is empty, perhaps a variable that is not set; give a"
    )
    assert not any(tmp_path.iterdir())


def test_fabrication_files_that_cannot_be_made_are_refused_before_the_board(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "fab").touch()
    done = run_fingertip("board", "--fab", "--out", tmp_path)
    assert done.returncode == 2
    assert "fab: is a file; choose another folder with --out." in done.stderr
    (tmp_path / "fab").unlink()
    monkeypatch.setenv("PATH", "")
    done = run_fingertip("board", "--fab", "--out", tmp_path)
    assert done.returncode == 2
    assert "kicad-cli is not on the PATH; install KiCad 9" in done.stderr
    assert not any(tmp_path.iterdir())
