"""What is added in one file, such as a row of a table, is completed, described, validated
and used.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.conftest import ROOT, run_python

DRIVER = """
import os, sys, typer
from fingertip.cli import app
from fingertip.cli.completion import answer_shell
command = typer.main.get_command(app)
for line in sys.argv[1:]:
    if line.startswith("complete "):
        os.environ["_TYPER_COMPLETE_ARGS"] = line.removeprefix("complete ")
        answer_shell(command)
    else:
        try:
            command(line.split(), prog_name="fingertip")
        except SystemExit as end:
            if end.code:
                raise
"""


def run_lines(folder: Path, sources: str, *lines: str) -> subprocess.CompletedProcess[str]:
    """Run the commands of some lines, or complete them, in one
    process that finds its modules in `sources`.
    """
    return run_python("-c", DRIVER, *lines, PYTHONPATH=sources, PWD=str(folder))


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")


def add_sensor(house: Path) -> None:
    rows = house / "src/fingertip/catalogues/sensors.csv"
    edit(
        rows,
        "\nfsr402,",
        "\nmine,Mine,5.08,7.62,0.30,38,6.4,2.54,[D] mine,,fsr400,,,,,,yes,\nfsr402,",
    )


def add_surface(house: Path) -> None:
    shutil.copy(house / "params/surfaces/wood.toml", house / "params/surfaces/mine.toml")


def add_format(house: Path) -> None:
    row = '    "mine": PartFormat(".mine", load_stl, is_default=False),\n    "cq": '
    edit(house / "src/fingertip/cad/files/part_formats.py", '    "cq": ', row)


ADDITIONS = {
    add_sensor: ("new tip --sensor mi", "new --help", "new tip --sensor mine", "tip.toml"),
    add_surface: (
        "simulate --surface mi",
        "simulate --help",
        "simulate --surface mine --out mine.csv",
        "mine.csv",
    ),
    add_format: (
        "build --formats mi",
        "build --help",
        "build fsr400 --formats mine --parts stand --out out",
        "out/stand.mine",
    ),
}


@pytest.mark.parametrize("add", ADDITIONS, ids=lambda add: add.__name__)
def test_one_edited_file_suffices(add, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "params", tmp_path / "params")
    add(tmp_path)
    completed, described, used, file = ADDITIONS[add]
    done = run_lines(
        tmp_path, str(tmp_path / "src"), f"complete fingertip {completed}", described, used
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "mine"
    assert add is add_surface or "mine" in done.stdout.split("Usage:")[1]
    assert (tmp_path / file).exists()
