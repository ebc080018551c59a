"""The SPICE deck in ngspice: transfer function of the filter, voltages of the bridge, rectifiers and comparator."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.analysis.response import decibel
from fingertip.board.components.bridge import sensor_conductance_s
from fingertip.board.components.values import SUPPLIES
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier
from fingertip.tasks.board import write_board
from tests.board.conftest import BoardFolder
from tests.board.ngspice import run_ngspice
from tests.designs import load_article
from tests.oracles.filter_formulas import filter_transfer

CONTROLLER = ["board.supply=single_3v3", "board.supply_v=3.3"]
DESIGNS = {
    "article": [],
    "another": ["board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.passband_gain=21", "board.series=E96"],
    "slow": ["board.cutoff_hz=5", "board.capacitor_uf=10"],
    "single supply": ["board.supply=single"],
    "precision": ["board.variant=precision"],
    "precision, single supply": ["board.variant=precision", "board.supply=single", "board.band_limit_hz=500"],
    "comparator": ["board.variant=comparator"],
    "comparator, single supply": ["board.variant=comparator", "board.supply=single", "board.capacitor_series=E12"],
    "article, 3.3 V": CONTROLLER,
    "precision, 3.3 V": ["board.variant=precision", *CONTROLLER],
    "comparator, 3.3 V": ["board.variant=comparator", *CONTROLLER, "board.cutoff_hz=90", "board.series=E96"],
}


def write_deck(folder: Path, changes: list[str]) -> tuple[Design, str]:
    design = load_article(changes)
    write_board(design, folder)
    return design, (folder / "slip_filter.cir").read_text(encoding="utf-8")


def max_deviation_db(folder: Path, design: Design, deck: str) -> float:
    """Maximum deviation of the deck from our transfer function [dB], from 1 Hz to 100 kHz."""
    rows = run_ngspice(folder, deck, "ac dec 40 1 100k\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    assert len(rows) > 200
    assert (rows[0][0], round(rows[-1][0])) == (1.0, 100_000)
    values, amplifier = board_values(design), choose_amplifier(design.board)
    arguments = values.preferred, amplifier.bandwidth_hz, values.first_stage_capacitors, amplifier.input_f
    return max(
        abs(decibel(complex(fr, fi) / complex(tr, ti)) - decibel(filter_transfer(f, *arguments)))
        for f, tr, ti, fr, fi in rows
    )


@pytest.mark.full
@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_deck_has_the_transfer_function_of_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, deck = write_deck(tmp_path, changes)
    assert max_deviation_db(tmp_path, design, deck) < 1e-2


@pytest.mark.parametrize("supply", SUPPLIES)
@pytest.mark.parametrize("force_n", [0.1, 0.8, 8.0])
def test_deck_has_the_tactile_voltage_of_the_bridge(tmp_path: Path, force_n: float, supply: str) -> None:
    design, deck = write_deck(tmp_path, [f"board.supply={supply}", f"board.supply_v={SUPPLIES[supply].nominal_v}"])
    line = next(line for line in deck.splitlines() if line.startswith("RJ1 "))
    conductance = sensor_conductance_s(force_n)
    deck = deck.replace(line, f"{' '.join(line.split()[:3])} {1 / conductance if conductance else 1e12:.10g}")
    rows = run_ngspice(tmp_path, deck, "op\nwrdata out v(tactile)")
    assert rows[0][-1] == pytest.approx(board_values(design).tactile_response.tactile_v(conductance), abs=1e-4)


def test_first_stage_capacitors_remove_offset_gain_and_high_frequency_gain(tmp_path: Path) -> None:
    design, deck = write_deck(tmp_path, ["board.variant=precision"])
    values = board_values(design)
    assert "C14 0 series 22u" in deck  # the first preferred value above 16 uF
    assert "C20 stage1_out feedback 1.5n" in deck
    assert values.first_stage_capacitors is not None
    without, with_capacitors = (
        (lambda f: filter_transfer(f, values.preferred, 3e6)),
        (lambda f: filter_transfer(f, values.preferred, 3e6, values.first_stage_capacitors)),
    )
    # Both have little effect inside the passband: C14 a decade above its corner, C20 an octave below its own. C14
    # removes the gain at DC.
    assert abs(with_capacitors(67.0) / without(67.0)) == pytest.approx(1, abs=5e-3)
    assert abs(with_capacitors(200.0) / without(200.0)) == pytest.approx(1, abs=0.02)
    assert abs(with_capacitors(1e-3)) < abs(without(1e-3)) / 60
    attenuation_db = decibel(with_capacitors(values.first_stage_capacitors.limit_hz) / without(1e3))
    assert attenuation_db == pytest.approx(-3.0, abs=0.15)


TONE_V, TONE_HZ, END_S, START_S, STEP_S = 1.0, 100.0, 0.06, 0.02, 2e-5


def tone(t: float) -> float:
    return TONE_V * math.sin(2 * math.pi * TONE_HZ * t)


def simulate_tone(folder: Path, deck: str, removed: tuple[str, ...], ground: str) -> list[tuple[float, float]]:
    """Times [s] and envelope above the signal ground [V] for a tone at FILTERED, without what drives that net."""
    isolated = "\n".join(line for line in deck.splitlines() if not line.startswith(removed))
    isolated = isolated.replace("\n.ac", f"\nVtest filtered {ground} sin(0 {TONE_V} {TONE_HZ})\n.ac") + "\n"
    vectors = "v(envelope)" if ground == "0" else f"v(envelope) v({ground})"
    rows = run_ngspice(
        folder, isolated, f"tran {STEP_S} {END_S} {START_S} 5u\nlinearize {vectors}\nwrdata out {vectors}"
    )
    return [(t, v - sum(ground_v)) for t, v, *ground_v in rows]


def simulate_peak_detector(until: float) -> list[tuple[float, float]]:
    """Simulate variant article independently: an exponential diode with series resistance, R_LP parallel to C_LP.

    Implicit Euler in steps of 1 us; bisection solves for the node's voltage. Slow and simple.
    """
    R, C, dt = 2000.0, 2.2e-6, 1e-6
    saturation, series, thermal = 2.52e-9, 0.568, 1.752 * 8.617333e-5 * 300.15

    def current(volt: float) -> float:
        """Current through the diode and its series resistance."""
        if volt <= 0:
            return saturation * (math.exp(volt / thermal) - 1)
        i = 0.0
        low, high = 0.0, volt / series
        for _ in range(40):
            i = 0.5 * (low + high)
            low, high = (i, high) if series * i + thermal * math.log1p(i / saturation) < volt else (low, i)
        return i

    v, samples = 0.0, []
    for n in range(1, round(until / dt) + 1):
        u = tone(n * dt)
        low, high = min(v, u, 0.0), max(v, u)
        if u - v < 0.2:  # off: 2 uA at most
            v = (v + dt * current(u - v) / C) / (1 + dt / (R * C))
        else:
            for _ in range(25):
                middle = 0.5 * (low + high)
                residue = C * (middle - v) / dt + middle / R - current(u - middle)
                low, high = (middle, high) if residue < 0 else (low, middle)
            v = high
        if n % 20 == 0:
            samples.append((n * dt, v))
    return samples


def simulate_ideal_rectifier(until: float) -> list[tuple[float, float]]:
    """Simulate variant precision independently: ideal rectifier and one pole, solved exactly in steps of 1 us."""
    dt = 1e-6
    keep, v, samples = math.exp(-dt / 4.4e-3), 0.0, []
    for n in range(1, round(until / dt) + 1):
        v = keep * v + (1 - keep) * max(tone((n - 0.5) * dt), 0.0)
        if n % 20 == 0:
            samples.append((n * dt, v))
    return samples


CASES = [
    ("article", "split"), ("article", "single"), ("precision", "split"), ("comparator", "single"),
    ("article", "single_3v3"), ("precision", "single_3v3"), ("comparator", "single_3v3"),
]  # fmt: skip


@functools.cache
def simulate_envelope(is_article: bool) -> dict[int, float]:
    """Simulate the envelope independently of ngspice: sample index -> envelope [V]."""
    return {
        round(t / STEP_S): v for t, v in (simulate_peak_detector if is_article else simulate_ideal_rectifier)(END_S)
    }


@pytest.mark.full
@pytest.mark.parametrize(("variant", "supply"), CASES, ids=map(" ".join, CASES))
def test_transients_equal_an_independent_simulation(
    board_folder: BoardFolder, tmp_path: Path, variant: str, supply: str
) -> None:
    """A tone drives the rectifier. On a single supply the signals are the same, relative to VMID."""
    changes = BOARD_CONFIGURATIONS[f"{variant}_{supply}"].changes
    deck = (board_folder(*changes) / "slip_filter.cir").read_text("utf-8")
    # R7 and C8 load the envelope with 1 % of C_LP. Both simulations leave them out.
    ngspice = simulate_tone(tmp_path, deck, ("XU1", "R2 ", "R7 "), "0" if supply == "split" else "vmid")
    simulated = simulate_envelope(variant == "article")
    pairs = [
        (v, simulated[round(t / STEP_S)]) for t, v in ngspice if round(t / STEP_S) in simulated and t > START_S + STEP_S
    ]
    assert len(pairs) > 1500
    assert max(abs(a - b) for a, b in pairs) < 5e-3
    steady = [a for a, _ in pairs][len(pairs) // 2 :]
    # The mean of an ideal half wave is 1/pi of its peak. The dead zone of the diode removes a quarter of it.
    assert math.fsum(steady) / len(steady) == pytest.approx(0.24 if variant == "article" else 1 / math.pi, abs=0.01)


@pytest.mark.full
@pytest.mark.parametrize("supply", SUPPLIES)
def test_comparator_switches_at_its_on_and_off_thresholds(tmp_path: Path, supply: str) -> None:
    """The mean sweeps slowly up and down through both thresholds. SLIP is low in between."""
    design, deck = write_deck(tmp_path, [*BOARD_CONFIGURATIONS[f"comparator_{supply}"].changes])
    levels = board_values(design).comparator_levels
    assert levels is not None
    assert levels.averaging_tau_s == pytest.approx(0.015, rel=0.05)  # half of the article's window of 30 ms
    isolated = "\n".join(line for line in deck.splitlines() if not line.startswith(("R18 ", "C17 ")))
    ground = "0" if supply == "split" else "vmid"
    isolated = isolated.replace("\n.ac", f"\nVmean mean {ground} pwl(0 0 1 0.04 2 0)\n.ac") + "\n"
    rows = run_ngspice(tmp_path, isolated, "tran 0.2m 2 0 0.2m\nwrdata out v(slip)")
    low = [t for t, v in rows if t > 0.01 and v < 1]
    on, off = 0.04 * low[0], 0.04 * (2 - low[-1])
    assert (on, off) == pytest.approx((levels.on_v, levels.off_v), abs=2e-4)
    # The output turns ON at the design's threshold, which E24 resistors approximate to within two percent.
    assert on == pytest.approx(0.017, rel=0.02)
    assert off == pytest.approx(0.75 * 0.017, rel=0.05)
    assert all(v > design.board.supply_v - 0.1 for t, v in rows if 0.04 * t < off - 1e-3)
