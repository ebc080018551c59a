"""`fingertip params` and `fingertip picture`."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np

from tests.conftest import design_file, run_fingertip


def test_params_lists_units_and_bounds() -> None:
    done = run_fingertip("params")
    assert done.returncode == 0
    line = next(line for line in done.stdout.splitlines() if line.startswith("mold.draft_deg"))
    assert "degree" in line
    assert ">= 0, <= 15" in line


def test_params_shows_the_values_of_a_design() -> None:
    output = json.loads(run_fingertip("params", design_file("fsr402"), "--set", "mold.wall_mm=5", "--json").stdout)
    shown = {p["name"]: p for p in output["parameters"]}
    assert shown["sensor.model"]["value"] == "fsr402_short"
    assert shown["mold.wall_mm"]["value"] == 5
    assert shown["mold.wall_mm"]["default"] == 4
    assert shown["mold.wall_mm"]["unit"] == "mm"


def test_params_prints_a_design_and_a_schema() -> None:
    assert tomllib.loads(run_fingertip("params", "--toml").stdout)["skin"]["width_mm"] == 17
    assert json.loads(run_fingertip("params", "--schema").stdout)["title"] == "fingertip design"


def test_picture_shows_the_colour_of_every_part(tmp_path: Path) -> None:
    from PIL import Image

    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.design import Design

    path = tmp_path / "p.png"
    done = run_fingertip("picture", design_file("fsr400"), "--out", path, "--width-px", "700", "-q")
    assert done.returncode == 0, done.stderr
    pixels = np.asarray(Image.open(path).convert("RGB"), dtype=float)
    assert pixels.shape[1] == 700
    drawn = pixels[(pixels < 250).any(axis=2)]
    assert 0.1 < len(drawn) / pixels[..., 0].size < 0.9
    hue = drawn / drawn.sum(axis=1, keepdims=True)
    for part in parts_by_name(Design()).values():
        own = np.array(part.colour) / sum(part.colour)
        assert (np.abs(hue - own).max(axis=1) < 0.01).mean() > 0.01, part.name
