"""`fingertip completion`: the scripts in the shells themselves."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import fingertip
from tests.conftest import run_fingertip
from tests.tools import require_tool

SHELLS = ("bash", "zsh", "fish")
SOURCES = Path(fingertip.__file__).parents[1]


@pytest.fixture(autouse=True)
def program(scripts: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The program, which a shell starts at the tab key."""
    monkeypatch.setenv("PATH", str(scripts), prepend=os.pathsep)


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("completion")
    for shell in SHELLS:
        done = run_fingertip("completion", shell)
        assert done.returncode == 0, done.stderr
        (folder / shell).write_text(done.stdout)
    program = folder / "fingertip"
    program.write_text(f'#!/bin/sh\nPYTHONPATH={SOURCES} exec {sys.executable} -m fingertip "$@"\n')
    program.chmod(0o755)
    (folder / "work").mkdir()
    (folder / "work" / "mine.toml").touch()
    (folder / "work" / "mine\x1b[31m.toml").touch()  # would colour the terminal
    return folder


def complete_in_bash(scripts: Path, line: str) -> list[str]:
    """What bash offers for the word at the end of a line: the
    words are split as readline splits them.
    """
    bash = require_tool("bash", "apt-get install bash")
    program = """
        source "$1"
        COMP_LINE=$2 COMP_POINT=${#2}
        breaks=' =:'
        COMP_WORDS=() word=''
        for ((i = 0; i < ${#COMP_LINE}; i++)); do
            letter=${COMP_LINE:i:1}
            if [[ $letter == ' ' ]]; then [[ -n $word ]] && COMP_WORDS+=("$word"); word=''
            elif [[ $breaks == *"$letter"* ]]; then COMP_WORDS+=("$word" "$letter"); word=''
            else word+=$letter; fi
        done
        COMP_WORDS+=("$word") COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        _fingertip fingertip
        printf '%s\\n' "${COMPREPLY[@]}"
    """
    done = subprocess.run(
        [bash, "--norc", "-c", program, "bash", scripts / "bash", line],
        capture_output=True,
        text=True,
        check=True,
        cwd=scripts / "work",
    )
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.full
def test_bash_completes(scripts: Path) -> None:
    """What the program answers, `transcripts/completion.txt` shows;
    bash cuts words at = and completes files itself.
    """
    for line, expected in (
        ("fingertip calibrate ", ["printer", "sensor"]),
        ("fingertip build mi", ["mine.toml"]),
        ("fingertip build fsr400 --set skin.wid", ["skin.width_mm="]),
        ("fingertip build fsr400 --set board.variant=pre", ["precision"]),
        ("fingertip build fsr400 --set=board.variant=pre", ["precision"]),
        ("fingertip build fsr400 --out mi", []),
    ):
        assert complete_in_bash(scripts, line) == expected


@pytest.mark.parametrize("shell", SHELLS)
def test_scripts_are_valid(scripts: Path, shell: str) -> None:
    program = require_tool(shell, f"apt-get install {shell}")
    done = subprocess.run(
        [program, "-n", scripts / shell], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
