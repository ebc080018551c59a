"""Noise and offset: part by part and in all as ngspice has them, and by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_files, board_values
from fingertip.board.analysis.analyse import analyse
from fingertip.board.analysis.equations import equations
from fingertip.board.analysis.noise import NETS, budget, remedies, total_v
from fingertip.board.values.bridge import sensor_conductance_s
from fingertip.board.values.white_noise import HALF_WAVE_MEAN, noise_warning
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.conftest import Written
from tests.board.ngspice import simulate
from tests.board.test_spice import deck_of

VALUES = board_values(Design())
CIRCUIT = board_circuit(VALUES)


def test_noise_of_resistors_is_ngspices(tmp_path: Path) -> None:
    """Per resistor, 1 Hz to 100 kHz at the filter's end."""
    system = equations(CIRCUIT, 3e6, sensor_conductance_s(0.8))
    f = np.logspace(0, 5, 2001)
    density = np.array([source.noise for source in system.sources])
    square = np.trapezoid(np.abs(system.transfers(f, "FILTERED") * density) ** 2, f, axis=0)
    ours = {source.name: math.sqrt(v) for source, v in zip(system.sources, square, strict=True)}
    resistors = ["R1", "R2", "R3", "R4", "R5", "R10", "R11", "R12", "R13", "R14"]
    _, deck = deck_of(tmp_path, [])
    names = " ".join(f"onoise_total_{name.lower()}" for name in resistors)
    rows = simulate(tmp_path, deck, f"noise v(filtered) IJ1 dec 200 1 100k 1\nsetplot noise2\nwrdata out {names}")
    for name, theirs in zip(resistors, rows[0][-len(resistors) :], strict=True):
        assert ours[name] == pytest.approx(theirs, rel=0.01), name


@pytest.mark.parametrize("name", ["article_split", "precision_split", "comparator_single"])
def test_the_whole_noise_is_ngspices(written: Written, tmp_path: Path, name: str) -> None:
    """All amplifiers and resistors, 0.1 Hz to 1 MHz: the filters do make 19 mV of it, and C20 leaves 6."""
    changes = VARIANTS[name].changes
    rows, total = budget(
        equations(board_circuit(board_values(Design.load(changes=changes))), 3e6, sensor_conductance_s(0.8))
    )
    assert rows[0].cause == "U2"
    deck = (written(*changes) / "slip_filter.cir").read_text("utf-8")
    for net in ("TACTILE", "FILTERED", "ADC_TACTILE"):
        found = simulate(
            tmp_path, deck, f"noise v({net.lower()}) IJ1 dec 100 0.1 1meg\nsetplot noise2\nwrdata out onoise_total"
        )
        # Against ground, as the converter's pins are; on a single supply the middle's noise is in it.
        assert total[NETS.index(net)] == pytest.approx(found[0][-1], rel=0.005), net
    assert total[NETS.index("FILTERED")] == pytest.approx(
        {"article_split": 19.6e-3, "precision_split": 6.13e-3, "comparator_single": 5.19e-3}[name], rel=0.01
    )


def test_what_would_lower_the_noise() -> None:
    """By density times bandwidth: 2.4 uV/sqrt(Hz) at the tactile voltage, 67.7 times it within one pole's bandwidth."""
    density = math.hypot(35e-9, 50e-9 / VALUES.bridge.gain) * VALUES.bridge.gain
    poles = 800e3 / VALUES.bridge.gain, 3e6 / VALUES.achieved.passband_gain
    bandwidth = math.pi / 2 * poles[0] * poles[1] / (poles[0] + poles[1])
    for variant in ("article", "precision"):
        found = {r.change: r for r in analyse(Design.load(changes=[f"board.variant={variant}"]), boards=10).quieter}
        open_, limited = (
            ("as built", "with C20 across R5") if variant == "article" else ("without C20 across R5", "as built")
        )
        assert found[open_].filtered_v == pytest.approx(
            density * VALUES.achieved.passband_gain * math.sqrt(bandwidth), rel=0.01
        )
        # 1061 Hz instead of 9.7 kHz, less what lies below the cutoff.
        assert found[limited].filtered_v / found[open_].filtered_v == pytest.approx(math.sqrt(1061 / 9670), abs=0.03)
        for change, r in found.items():
            assert r.rest_v == pytest.approx(r.filtered_v / math.sqrt(2 * math.pi), rel=1e-12)
            if "INA821" in change:
                assert r.filtered_v < 0.25 * found[change.split(",")[0]].filtered_v
    assert found["as built"].rest_v < 0.15 * Design().detector.threshold_v


def test_the_mean_of_rectified_noise() -> None:
    """1 / sqrt(2 pi) of its deviation, by drawing."""
    draw = np.random.default_rng(3).normal(size=200_000)
    assert np.maximum(draw, 0.0).mean() == pytest.approx(HALF_WAVE_MEAN, rel=0.01)


def test_budgets_name_what_matters() -> None:
    found = analyse(Design(), boards=100)
    assert found.noise[0].cause == "U2"
    offsets = {item.cause: dict(zip(NETS, item.volts, strict=True)) for item in found.offset}
    # The article's slip: 3 mV become 203 mV ahead of C2, and nothing behind it.
    assert offsets["U1a"]["STAGE1_OUT"] == pytest.approx(0.203, abs=0.001)
    assert offsets["U1a"]["FILTERED"] == 0
    assert offsets["U1b"]["FILTERED"] == pytest.approx(3e-3, rel=1e-3)
    assert offsets["U2"]["TACTILE"] == pytest.approx(200e-6 * VALUES.bridge.gain, rel=1e-6)
    assert offsets["R10 to R14"]["ADC_TACTILE"] == offsets["R10 to R14"]["TACTILE"] > 0.01


@pytest.mark.parametrize("name", VARIANTS)
def test_the_folders_readme_says_this_noise(written: Written, name: str) -> None:
    changes = VARIANTS[name].changes
    found = analyse(Design.load(changes=changes), boards=10)
    text = " ".join((written(*changes) / "README.md").read_text("utf-8").split())
    at = {
        r.change.split(" ")[0] if "C20" in r.change else r.change: r for r in found.quieter if "INA821" not in r.change
    }
    first = board_values(Design.load(changes=changes)).first_stage
    article = name.startswith("article")
    open_v = at["as built" if article else "without"].filtered_v
    single = name.endswith("single")
    tactile = found.noise_total_v[NETS.index("TACTILE")]
    assert f"leaves {1e3 * tactile:.1f} mV of noise" in text
    assert f"{1e3 * open_v:.0f} mV of it" in text
    if not article:
        assert first is not None
        assert f"gain at {first.limit_hz:.0f} Hz, leaves {1e3 * at['as built'].filtered_v:.2g} mV" in text
        assert f"rests at {1e3 * at['as built'].rest_v:.1f} mV, well below the threshold of 17 mV" in text
    assert single == ("buffered middle" in text)


LOUD = ("board.passband_gain=300", "board.gain_bandwidth_hz=1e7")


@pytest.mark.parametrize("changes", [(), LOUD, ("board.passband_gain=10", "board.band_limit_hz=3000")])
@pytest.mark.parametrize("name", VARIANTS)
def test_the_formulas_noise_is_the_circuits(name: str, changes: tuple[str, ...]) -> None:
    """Of every part together, in every variant, within 1 %."""
    design = Design.load(changes=(*VARIANTS[name].changes, *changes))
    values, product = board_values(design), design.board.gain_bandwidth_hz
    circuit, noise = board_circuit(values), values.noise
    found = {r.change: r for r in remedies(circuit, product, design.board.band_limit_hz, values.variant == "article")}
    # The bridge's resistors are 0.1 % of it. On a single supply the middle's noise is the circuit's alone.
    near = 0.004 if name.endswith("single") else 0.0005
    assert noise.tactile_v == pytest.approx(total_v(circuit, product, "TACTILE"), rel=near)
    assert noise.filtered_v == pytest.approx(found["as built"].filtered_v, rel=0.01)
    if values.variant == "article":
        assert noise.open_v == noise.filtered_v
        assert noise.rest_v is None
    else:
        assert noise.open_v == pytest.approx(found["without C20 across R5"].filtered_v, rel=0.01)
        assert noise.rest_v == pytest.approx(found["as built"].rest_v, rel=0.01)


@pytest.mark.parametrize(
    ("threshold", "where"), [("0.004", "above"), ("0.012", "below"), ("0.017", "below"), ("0.1", "well below")]
)
def test_a_board_that_says_slip_at_rest_is_told(threshold: str, where: str) -> None:
    design = Design.load(changes=("board.variant=precision", *LOUD, f"detector.threshold_v={threshold}"))
    text = " ".join(board_files(design)["README.md"].decode().split())
    assert f"rests at 10.9 mV, {where} the threshold of {1e3 * float(threshold):g} mV" in text
    warning = noise_warning(board_values(design).noise, design.detector.threshold_v)
    assert bool(warning) == (where == "above")
    assert ("says slip with nothing touching" in text) == bool(warning)


def test_behind_the_diode_no_noise_is_told() -> None:
    design = Design.load(changes=(*LOUD, "detector.threshold_v=0.004"))
    assert noise_warning(board_values(design).noise, 0.004) == ""
