"""PrusaSlicer: what is asked of it, with a stand-in for the program, and what is read from what it writes."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.cad.printing import slicer
from fingertip.cad.printing.slicer import PrintEstimate, find_slicer, parse_gcode, slice_plate, slice_to_gcode
from fingertip.design import Design
from fingertip.foundation.errors import GeometryError

ESTIMATES = "; filament used [cm3] = 2.87\n; estimated printing time (normal mode) = 1d 2h 31m 30s\n"


def write_program(folder: Path, script: str) -> Path:
    """Shell script that stands for the slicer; `$out` is the file of the G-code, `$in` the plate."""
    program = folder / "prusa-slicer"
    find = 'while [ $# -gt 1 ]; do [ "$1" = -o ] && out=$2; shift; done; in=$1'
    program.write_text(f"#!/bin/sh\nall=$*\n{find}\n{script}\n", encoding="utf-8")
    program.chmod(0o755)
    return program


def test_program_is_found_on_the_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_slicer() is None
    program = write_program(tmp_path, "true")
    assert find_slicer() == program


@pytest.mark.parametrize(("layer_mm", "first_mm"), [(0.1, "0.2"), (0.3, "0.3")])
def test_program_is_given_plate_bed_and_layers(tmp_path: Path, layer_mm: float, first_mm: str) -> None:
    """The first layer is never thinner than 0.2 mm."""
    design = Design.load(changes=["printer.bed_x_mm=200", "printer.bed_y_mm=180"])
    program = write_program(tmp_path, 'echo "$all" > "$out"; cat "$in" >> "$out"')
    words, plate = slice_to_gcode(program, "mine", b"the plate", design, layer_mm).splitlines()
    assert plate == "the plate"
    assert "--bed-shape 0x0,200x0,200x180,0x180 " in words
    assert f"--layer-height {layer_mm:g} --first-layer-height {first_mm} " in words
    assert words.endswith("mine.3mf")


def test_estimates_of_a_sliced_plate_are_returned(tmp_path: Path) -> None:
    program = write_program(tmp_path, f"printf '{ESTIMATES}' > $out; exit 1")
    minutes = (1 * 24 + 2) * 60 + 31 + 0.5
    assert slice_plate(program, "mine", b"", Design()) == PrintEstimate(minutes, 2.87), "its exit code says nothing"


@pytest.mark.parametrize(
    ("script", "line"),
    [
        ("echo first >&2; echo last >&2; echo out", "last"),
        ("echo first; echo last", "last"),
        ("echo out; echo ' ' >&2", "out"),
        ("true", "no message"),
    ],
)
def test_last_words_of_a_program_without_gcode_are_quoted(tmp_path: Path, script: str, line: str) -> None:
    with pytest.raises(GeometryError, match=rf"^mine: PrusaSlicer could not slice it \({line}\); remove slicer\.$"):
        slice_plate(write_program(tmp_path, script), "mine", b"", Design())


def test_program_that_takes_long_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert slicer.TIME_LIMIT_S == 300.0
    monkeypatch.setattr(slicer, "TIME_LIMIT_S", 0.05)
    with pytest.raises(GeometryError, match=r"^mine: PrusaSlicer did not finish within 0\.05 s; remove slicer\.$"):
        slice_plate(write_program(tmp_path, "exec sleep 20"), "mine", b"", Design())


@pytest.mark.parametrize("line", ESTIMATES.splitlines())
def test_gcode_with_one_of_the_two_estimates_is_refused(line: str) -> None:
    with pytest.raises(GeometryError, match=r"^mine: .* states no print time or no filament volume; remove slicer"):
        parse_gcode("mine", f"G1 X0\n{line}\n")
