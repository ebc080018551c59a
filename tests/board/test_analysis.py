"""Analysis without a simulator, against formulas, ngspice, and itself said otherwise."""

from __future__ import annotations

import csv
import io
import json
import math
import random
from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis import analyse, bode_table
from fingertip.board.bridge import fit_bridge, sensor_conductance_s
from fingertip.board.built import first_stage, network, open_loop
from fingertip.board.equations import equations
from fingertip.board.figures import FIGURES, NAMES, figures, monte_carlo, nominal, sensitivities
from fingertip.board.filters import decibel, overall_cutoff_hz, response
from fingertip.board.noise import HALF_WAVE_MEAN, NETS, budget
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.conftest import Written
from tests.board.ngspice import simulate
from tests.board.test_spice import deck_of
from tests.conftest import run_fingertip

VALUES = board_values(Design())
CIRCUIT = board_circuit(VALUES)


@pytest.mark.parametrize("name", VARIANTS)
def test_bode_of_the_circuit_is_the_formulas(name: str) -> None:
    """Of every variant, against where signals rest; and the resistors' middle stays where it is."""
    f = np.logspace(0, 5, 101)
    values = board_values(Design.load(changes=VARIANTS[name].changes))
    system = equations(board_circuit(values), 3e6, 1e-4, "TACTILE")
    wanted = np.array([network(float(x), values.preferred, 3e6, values.first_stage) for x in f])
    assert np.max(np.abs(system.response(f, "FILTERED") / wanted - 1)) < 1e-9
    first = np.array([first_stage(float(x), values.preferred, 3e6, values.first_stage) for x in f])
    assert np.max(np.abs(system.response(f, "STAGE1_OUT") / first - 1)) < 1e-9
    if name.endswith("single"):
        assert np.max(np.abs(system.response(f, "VMID"))) < 1e-12


def test_bode_table() -> None:
    rows = list(csv.DictReader(io.StringIO(bode_table(Design()))))
    assert len(rows) == 201
    assert (float(rows[0]["frequency_hz"]), float(rows[-1]["frequency_hz"])) == (1.0, 1e5)
    for row in rows[::20]:
        f = float(row["frequency_hz"])
        assert float(row["whole_db"]) == pytest.approx(decibel(network(f, VALUES.preferred, 3e6)), abs=2e-3)
        assert float(row["stage1_db"]) + float(row["stage2_db"]) == pytest.approx(float(row["whole_db"]), abs=2e-4)
        # Between the amplifier's corner and its gain-bandwidth, as the article draws it.
        if f > 100:
            assert float(row["open_loop_db"]) == pytest.approx(decibel(open_loop(f, 3e6)), abs=0.1)
            assert float(row["whole_db"]) < float(row["open_loop_db"])


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


@pytest.mark.parametrize("name", ["paper_split", "precision_split", "comparator_single"])
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
        {"paper_split": 19.6e-3, "precision_split": 6.13e-3, "comparator_single": 5.19e-3}[name], rel=0.01
    )


def test_what_would_lower_the_noise() -> None:
    """By density times bandwidth: 2.4 uV/sqrt(Hz) at the tactile voltage, 67.7 times it within one pole's bandwidth."""
    density = math.hypot(35e-9, 50e-9 / VALUES.bridge.gain) * VALUES.bridge.gain
    poles = 800e3 / VALUES.bridge.gain, 3e6 / VALUES.achieved.passband_gain
    bandwidth = math.pi / 2 * poles[0] * poles[1] / (poles[0] + poles[1])
    for variant in ("paper", "precision"):
        found = {r.change: r for r in analyse(Design.load(changes=[f"board.variant={variant}"]), boards=10).quieter}
        open_, limited = (
            ("as built", "with C20 across R5") if variant == "paper" else ("without C20 across R5", "as built")
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


def test_the_mean_of_rectified_noise(tmp_path: Path) -> None:
    """1 / sqrt(2 pi) of its deviation, by drawing."""
    draw = np.random.default_rng(3).normal(size=200_000)
    assert np.maximum(draw, 0.0).mean() == pytest.approx(HALF_WAVE_MEAN, rel=0.01)


def test_limits_of_both_supplies() -> None:
    split, single = (board_values(Design.load(changes=[f"board.supply={s}"])).limits for s in ("split", "single"))
    assert (split.rest_v, single.rest_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-4)
    for found in (split, single):
        assert 0 < found.tactile_least_v < 3.85 < 4.3 < found.tactile_most_v < 4.5
    assert found.tactile_most_v <= found.clamp_high_v


@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize("supply_v", [5.0, 5.5, 6.0])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_the_bridges_amplifier_stays_within_its_rails(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    assert board_values(Design.load(changes=changes)).limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_would_not_do_on_a_single_supply() -> None:
    """Why it returns to the middle: the AD623's inner amplifiers would have to go below ground."""
    from fingertip.board.limits import limits
    from fingertip.board.supplies import SUPPLIES

    bridge = fit_bridge(5.0, "E24", 5.08)
    assert limits(bridge, SUPPLIES["split"], 5.0, 67.7, True).bridge_amplifier_margin_v > 0
    assert limits(bridge, SUPPLIES["single"], 5.0, 67.7, True).bridge_amplifier_margin_v < -1


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


def test_figures_of_the_fitted_values_are_the_formulas() -> None:
    found = figures(nominal(VALUES.preferred))
    wanted = response(VALUES.preferred, 3e6)
    for name in FIGURES:
        assert float(found[name]) == pytest.approx(getattr(wanted, name), rel=1e-12)


def test_unequal_capacitors_by_the_network(tmp_path: Path) -> None:
    """The cutoff with three different capacitors, looked up in ngspice's own sweep."""
    _, deck = deck_of(tmp_path, [])
    for name, value in {"C1 tactile stage1_in": "1.05u", "C2 stage1_out stage2_mid": "0.93u",
                        "C3 stage2_mid stage2_in": "1.08u"}.items():  # fmt: skip
        assert f"{name} 1u" in deck
        deck = deck.replace(f"{name} 1u", f"{name} {value}")
    rows = simulate(tmp_path, deck, "ac dec 5000 50 90\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    gain = [(f, abs(complex(fr, fi) / complex(tr, ti))) for f, tr, ti, fr, fi in rows]
    level = (1 + 100 / 1.5) / math.sqrt(2)
    crossing = next(f for f, g in gain if g >= level)
    values = nominal(VALUES.preferred) * np.array([1, 1, 1, 1, 1, 1.05, 0.93, 1.08])
    assert float(figures(values)["cutoff_hz"]) == pytest.approx(crossing, rel=1e-3)


def test_monte_carlo_against_drawing_one_by_one() -> None:
    """Plain Python, one board after the other, with the scalar formulas; both are estimates of the same spread."""
    draw = random.Random(5)
    base = [float(v) for v in nominal(VALUES.preferred)]
    found = []
    for _ in range(4000):
        r1, r2, r3, _, _, c1, c2, c3 = (
            v * (1 + (0.01 if i < 5 else 0.05) * draw.uniform(-1, 1)) for i, v in enumerate(base)
        )
        f0 = 1 / (2 * math.pi * math.sqrt(r2 * r3 * c2 * c3))
        q = math.sqrt(r3 / r2) * math.sqrt(c2 * c3) / (c2 + c3)
        found.append(overall_cutoff_hz(1 / (2 * math.pi * r1 * c1), f0, q))
    mean = math.fsum(found) / len(found)
    deviation = math.sqrt(math.fsum((f - mean) ** 2 for f in found) / (len(found) - 1))
    spread = monte_carlo(VALUES.preferred, 1.0, 5.0)["cutoff_hz"]
    assert spread.mean == pytest.approx(mean, abs=5 * deviation / math.sqrt(4000))
    assert spread.deviation == pytest.approx(deviation, rel=0.06)
    assert spread.worst_low < min(found) < spread.low_95 < spread.high_95 < max(found) < spread.worst_high


def test_monte_carlo_repeats_and_shrinks() -> None:
    one = monte_carlo(VALUES.preferred, 1.0, 5.0)
    assert one == monte_carlo(VALUES.preferred, 1.0, 5.0)
    assert one != monte_carlo(VALUES.preferred, 1.0, 5.0, seed=2)
    exact = monte_carlo(VALUES.preferred, 0.0, 0.0, boards=10)["cutoff_hz"]
    assert exact.deviation < 1e-9
    assert exact.low_95 == exact.worst_high == exact.nominal


def test_sensitivities_follow_from_dimensions() -> None:
    """Every resistor up by 1 % lowers all frequencies by 1 %, and so does every capacitor."""
    found = sensitivities(VALUES.preferred)
    for name in ("cutoff_hz", "section_hz", "first_pole_hz"):
        assert sum(found[name][part] for part in ("R1", "R2", "R3")) == pytest.approx(-1, abs=1e-5)
        assert sum(found[name][part] for part in ("C1", "C2", "C3")) == pytest.approx(-1, abs=1e-5)
    assert found["section_quality"]["R3"] == -found["section_quality"]["R2"] == pytest.approx(0.5, abs=1e-5)
    assert list(found["passband_gain"]) == list(NAMES)


def test_command(tmp_path: Path) -> None:
    table = tmp_path / "bode.csv"
    run = run_fingertip("board", "--analysis", "--bode", table, "--json", "--quiet", "--out", tmp_path / "pcb")
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert set(data["analysis"]["spread"]) == set(FIGURES)
    assert table.read_text().startswith("frequency_hz,")
    assert str(table) in data["files"]
    text = run_fingertip("board", "--analysis", "--quiet", "--out", tmp_path / "pcb").stdout
    for words in ("noise, 0.1 Hz to 1 MHz", "202.93 mV", "-3 dB overall [Hz]", "% for 1 % of"):
        assert words in text


def test_monte_carlo_is_ngspices_board_by_board(tmp_path: Path) -> None:
    """Forty boards drawn here, each swept by ngspice: every one's cutoff is ours, and so the spread is."""
    rng = np.random.default_rng(3)
    tolerance = np.array([0.01] * 5 + [0.05] * 3)
    boards = nominal(VALUES.preferred) * (1 + tolerance * rng.uniform(-1, 1, (40, len(NAMES))))
    _, deck = deck_of(tmp_path, [])
    commands = []
    for i, board in enumerate(boards):
        commands += [f"alter {name} = {value:.12g}" for name, value in zip(NAMES, board, strict=True)]
        commands += ["ac dec 4000 60 75", f"wrdata out{i} vr(tactile) vi(tactile) vr(filtered) vi(filtered)"]
    simulate(tmp_path, deck, "\n".join([*commands, "wrdata out v(filtered)"]))
    theirs = []
    for i, board in enumerate(boards):
        level = (1 + board[4] / board[3]) / math.sqrt(2)
        for line in (tmp_path / f"out{i}").read_text().splitlines():
            f, tr, ti, fr, fi = (float(word) for word in line.split())
            if abs(complex(fr, fi) / complex(tr, ti)) >= level:
                theirs.append(f)
                break
    ours = figures(boards)["cutoff_hz"]
    assert len(theirs) == len(ours)
    assert np.max(np.abs(ours / np.array(theirs) - 1)) < 1e-3
    assert float(ours.std()) == pytest.approx(float(np.std(theirs)), rel=0.01)
    assert float(ours.std()) > 0.8


@pytest.mark.parametrize("name", VARIANTS)
def test_the_folders_readme_says_this_noise(written: Written, name: str) -> None:
    changes = VARIANTS[name].changes
    found = analyse(Design.load(changes=changes), boards=10)
    text = " ".join((written(*changes) / "README.md").read_text("utf-8").split())
    at = {
        r.change.split(" ")[0] if "C20" in r.change else r.change: r for r in found.quieter if "INA821" not in r.change
    }
    paper = name.startswith("paper")
    open_v = at["as built" if paper else "without"].filtered_v
    single = name.endswith("single")
    tactile = found.noise_total_v[NETS.index("TACTILE")]
    assert f"leaves {1e3 * tactile:.1f} mV of noise" in text
    assert f"{1e3 * open_v:.0f} mV of it" in text
    if not paper:
        assert f"leaves {1e3 * at['as built'].filtered_v:.0f} mV" in text
        assert f"rests at {1e3 * at['as built'].rest_v:.1f} mV" in text
    assert single == ("buffered middle" in text)
