"""README, user pages and examples: every command they show runs, and
every picture and file they name exists.
"""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import ROOT, run_fingertip, run_python
from tests.tools import require_module

FIRST = (
    "README.md",
    "docs/tutorial.md",
    "docs/designs.md",
    "docs/files.md",
    "docs/casting.md",
    "docs/board.md",
    "docs/simulation.md",
)
"""Pages whose commands make what those of other pages read."""
DOCS = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md"))
PAGES = {page: (ROOT / page).read_text() for page in dict.fromkeys((*FIRST, *DOCS))}
BLOCKS = [
    block
    for text in PAGES.values()
    for block in re.findall(r"^```(\w+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
]
LINKS = [
    (page, link)
    for page, text in PAGES.items()
    for link in re.findall(r"\]\(([^)#]+)\)", text)
    if "://" not in link
]
COMMANDS = [
    command.strip()
    for language, block in BLOCKS
    if language == "sh"
    for line in block.splitlines()
    for command in line.split("&&")
]
(WEIGHINGS,) = (block for language, block in BLOCKS if language == "csv")
OURS = [command for command in COMMANDS if command.startswith(".venv/bin/fingertip")]
DISTINCT = list(
    {
        re.sub(r"\bparams/(\w+)\.toml", r"\1", command): command for command in reversed(OURS)
    }.values()
)[::-1]
"""Each command once: a bundled design is the same by its name and by its file."""


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that looks like a clone to the commands."""
    folder = tmp_path_factory.mktemp("clone")
    (folder / "params").symlink_to(ROOT / "params")
    for name, text in recordings().items():
        (folder / name).write_text(text)
    (folder / "my_weighings.csv").write_text(WEIGHINGS)
    return folder


def recordings() -> dict[str, str]:
    """Files of the section on recordings: one second with slip in it, as several programs
    write it.
    """
    noise = np.random.default_rng(0).normal(0, 4e-4, 5000)

    def samples(rate_hz: int, unit: str = "{:.6f}", per_volt: float = 1.0) -> list[tuple[str, str]]:
        times = [i / rate_hz for i in range(rate_hz)]
        slip = [0.01 * math.sin(2 * math.pi * 90 * t) if 0.5 < t < 0.7 else 0.0 for t in times]
        return [
            (f"{t:.6f}", unit.format((2.0 + s + n) * per_volt))
            for t, s, n in zip(times, slip, noise, strict=False)
        ]

    def lines(header: str, rows: Iterable[str]) -> str:
        return "\n".join([header, *rows]) + "\n"

    streamed = [",".join(sample) for sample in samples(2000)]
    for line in (300, 1300):  # saved in the middle of a stream, whose header is repeated
        streamed.insert(line, "time_s,voltage_v")
    return {
        "rec.csv": lines(streamed[0], streamed[1:]),
        "daq.csv": lines("Time [s],AI0 (V)", map(",".join, samples(2000))),
        "stream.csv": lines("time_s,voltage_v", map(",".join, samples(2000))),
        "counts.csv": lines(
            "voltage_v", (counts for _, counts in samples(5000, "{:.0f}", 65536 / 20))
        ),
        "force.csv": lines("time_s;force_n", map(";".join, samples(2000))),
        "micros.txt": lines(
            "0 2.0", (f"{round(1e6 * float(t))} {v}" for t, v in samples(2000)[1:])
        ),
    }


def test_pages_show_commands_to_copy_and_links_that_lead_to_files() -> None:
    shell = [block for language, block in BLOCKS if language == "sh"]
    assert shell[0].startswith("sh install.sh && .venv/bin/fingertip make params/first_finger.toml")
    assert shell[1] == "sh install.sh test && .venv/bin/pytest -n auto --dist loadfile\n"
    assert all(block.count("\n") == 1 for block in shell[:2]), "one pasteable line each"
    others = {command for command in COMMANDS if command not in OURS}
    benchmark = ".venv/bin/python -m benchmarks.slip --share 0.1 --detectors fast,incipient,cusum"
    assert others == {
        "sh install.sh",
        "sh install.sh test",
        ".venv/bin/pytest -n auto --dist loadfile",
        benchmark,
    }
    assert len(OURS) >= 40
    assert len(PAGES["README.md"].splitlines()) <= 90, "reference belongs in docs/"
    assert len(LINKS) > 50
    assert [link for link in LINKS if not (ROOT / link[0]).parent.joinpath(link[1]).exists()] == []


@pytest.mark.full
@pytest.mark.parametrize("command", DISTINCT)
def test_command_runs(command: str, clone: Path) -> None:
    words, _, source = command.partition(" < ")
    if words.split()[1] == "drawing":
        require_module("reportlab")
    if "socket.step" in words:  # a bar along x, to whose end at 20 mm the base is joined
        cadquery = require_module("cadquery")
        cadquery.exporters.export(
            cadquery.Workplane().box(14, 8, 7.5).translate((13, 0, 0)), str(clone / "socket.step")
        )
    given = (clone / source).read_text() if source else None
    done = run_fingertip(*shlex.split(words)[1:], given=given, PWD=str(clone))
    assert done.returncode == 0, done.stderr
    if any(name in words for name in recordings()) or source:
        assert re.search(r"^(ON|detected) ", done.stdout, flags=re.MULTILINE)


@pytest.mark.full
def test_files_the_readme_promises(clone: Path) -> None:
    """After the commands above, in the order of this module."""
    made = {str(path.relative_to(clone)) for path in clone.rglob("*") if path.is_file()}
    for part in ("bone", "core", "skin", "mold_palmar", "mold_dorsal", "stand"):
        assert {f"out/first_finger/{part}.{kind}" for kind in ("stl", "3mf", "step")} <= made
    named = {
        "assembly.step",
        "report.json",
        "design.toml",
        "drawing.pdf",
        "acceptance.md",
        "casting.md",
    }
    named |= {"signal/trace.csv", "signal/slip.svg", "signal/detection.json", "steps/01-print.png"}
    named |= {
        "print/plate_fdm.3mf",
        "print/bone.stl",
        "print/mold_dorsal.stl",
        "firmware/slip_lamp/slip_lamp.ino",
    }
    named |= {"board/slip_filter.net", "board/slip_filter.cir", "board/bom.csv", "board/wiring.svg"}
    assert {f"out/first_finger/{file}" for file in named} <= made
    assert {
        "out/board/slip_filter.kicad_pcb",
        "out/wider/exploded.png",
        "out/wider/bone.stl",
        "myfinger.toml",
    } <= made


@pytest.mark.full
@pytest.mark.parametrize("script", [block for language, block in BLOCKS if language == "python"])
def test_python_block_runs(script: str, clone: Path) -> None:
    done = run_python("-c", script, PWD=str(clone))
    assert done.returncode == 0, done.stderr
    assert ("Interval(" if "found.intervals" in script else "") in done.stdout
    assert done.stdout.strip() if "print(" in script else (clone / "out/mine/bone.stl").exists()


def test_the_quoted_message_is_the_message_printed(clone: Path) -> None:
    quoted = re.search(r"`(skin\.width_mm: [^`]*)`", PAGES["README.md"])
    assert quoted
    done = run_fingertip("build", "params/fsr400.toml", "--set", "skin.width_mm=15", PWD=str(clone))
    assert done.returncode == 2
    assert f"error: {' '.join(quoted[1].split())}" in done.stderr


ELSEWHERE = {
    "hold_a_slipping_block",
    "continue_in_build123d",
    "lerobot_sensor",
    "ros2_node",
    "slip_in_mujoco",
}
"""Examples that need MuJoCo, LeRobot or ROS, which have tests of
their own, or an environment of build123d.
"""
EXAMPLES = sorted(path for path in (ROOT / "examples").glob("*.py") if path.stem not in ELSEWHERE)


@pytest.mark.full
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(example: Path, tmp_path: Path) -> None:
    """As its docstring says, and prints a result."""
    assert len(EXAMPLES) >= 3
    (tmp_path / "params").symlink_to(ROOT / "params")
    done = run_python(str(example), PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert f"examples/{example.name}" in example.read_text(encoding="utf-8")
