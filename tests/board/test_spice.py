"""The SPICE deck, run by ngspice: the filter as the formulas have it, the bridge's voltages, the rectifier."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import pytest

from fingertip.board import board_values, write_board
from fingertip.board.values.bridge import sensor_conductance_s
from fingertip.board.values.built import network
from fingertip.board.values.filters import decibel, filter_network
from fingertip.design import Design
from tests.board.conftest import Written
from tests.board.ngspice import simulate

DESIGNS = {
    "article": [],
    "another": ["board.cutoff_hz=120", "board.capacitor_uf=0.22", "board.passband_gain=21", "board.series=E96"],
    "slow": ["board.cutoff_hz=5", "board.capacitor_uf=10", "board.gain_bandwidth_hz=1e5"],
    "single supply": ["board.supply=single"],
    "precision": ["board.variant=precision"],
    "precision, single supply": ["board.variant=precision", "board.supply=single", "board.band_limit_hz=500"],
    "comparator": ["board.variant=comparator"],
    "comparator, single supply": ["board.variant=comparator", "board.supply=single", "board.capacitor_series=E12"],
}


def deck_of(folder: Path, changes: list[str]) -> tuple[Design, str]:
    design = Design.load(changes=changes)
    write_board(design, folder)
    return design, (folder / "slip_filter.cir").read_text(encoding="utf-8")


def worst_db(folder: Path, design: Design, deck: str) -> float:
    """Largest deviation of the deck from our transfer function, 1 Hz to 100 kHz [dB]."""
    rows = simulate(folder, deck, "ac dec 40 1 100k\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)")
    assert len(rows) > 200
    assert (rows[0][0], round(rows[-1][0])) == (1.0, 100_000)
    values, gbw = board_values(design), design.board.gain_bandwidth_hz
    return max(
        abs(decibel(complex(fr, fi) / complex(tr, ti)) - decibel(network(f, values.preferred, gbw, values.first_stage)))
        for f, tr, ti, fr, fi in rows
    )


@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_the_deck_is_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, deck = deck_of(tmp_path, changes)
    assert worst_db(tmp_path, design, deck) < 1e-2


@pytest.mark.parametrize(("right", "wrong"), [("R2 stage2_mid filtered 1.2k", "R2 stage2_mid filtered 1.21k"),
                                              ("C1 tactile stage1_in 1u", "C1 tactile stage1_in 0.99u")])  # fmt: skip
def test_a_part_one_percent_off_is_seen(tmp_path: Path, right: str, wrong: str) -> None:
    design, deck = deck_of(tmp_path, [])
    assert right in deck
    assert worst_db(tmp_path, design, deck.replace(right, wrong)) > 1e-2


def test_built_tends_to_the_formulas() -> None:
    values = board_values(Design()).preferred
    for f in (1.0, 67.0, 1e4):
        # What is left is 1/A0 at G = 67.7: 3e-4.
        assert network(f, values, 1e15) == pytest.approx(filter_network(f, values), rel=1e-3)


@pytest.mark.parametrize("supply", ["split", "single"])
@pytest.mark.parametrize("force_n", [0.1, 0.8, 8.0])
def test_the_bridges_voltage(tmp_path: Path, force_n: float, supply: str) -> None:
    design, deck = deck_of(tmp_path, [f"board.supply={supply}"])
    line = next(line for line in deck.splitlines() if line.startswith("RJ1 "))
    conductance = sensor_conductance_s(force_n)
    deck = deck.replace(line, f"{' '.join(line.split()[:3])} {1 / conductance if conductance else 1e12:.10g}")
    rows = simulate(tmp_path, deck, "op\nwrdata out v(tactile)")
    assert rows[0][-1] == pytest.approx(board_values(design).bridge.tactile_v(conductance, 5.0), abs=1e-4)


def test_the_first_stages_capacitors_do_what_they_are_for(tmp_path: Path) -> None:
    design, deck = deck_of(tmp_path, ["board.variant=precision"])
    values = board_values(design)
    assert "C14 0 series 22u" in deck  # 16 uF at least
    assert "C20 stage1_out feedback 1.5n" in deck
    assert values.first_stage is not None
    plain, extra = (
        (lambda f: network(f, values.preferred, 3e6)),
        (lambda f: network(f, values.preferred, 3e6, values.first_stage)),
    )
    # A decade above its corner the one costs little, an octave below its own the other; the offset is not amplified.
    assert abs(extra(67.0) / plain(67.0)) == pytest.approx(1, abs=5e-3)
    assert abs(extra(200.0) / plain(200.0)) == pytest.approx(1, abs=0.02)
    assert abs(extra(1e-3)) < abs(plain(1e-3)) / 60
    assert decibel(extra(values.first_stage.limit_hz) / plain(1e3)) == pytest.approx(-3.0, abs=0.15)


TONE_V, TONE_HZ, END_S, FROM_S, STEP_S = 1.0, 100.0, 0.06, 0.02, 2e-5


def tone(t: float) -> float:
    return TONE_V * math.sin(2 * math.pi * TONE_HZ * t)


def transient(folder: Path, deck: str, drop: tuple[str, ...], zero: str) -> list[tuple[float, float]]:
    """Envelope [V] over its rest, over time [s], for a tone at FILTERED, with what drives that net taken out."""
    alone = "\n".join(line for line in deck.splitlines() if not line.startswith(drop))
    alone = alone.replace("\n.ac", f"\nVtest filtered {zero} sin(0 {TONE_V} {TONE_HZ})\n.ac") + "\n"
    shown = "v(envelope)" if zero == "0" else f"v(envelope) v({zero})"
    rows = simulate(folder, alone, f"tran {STEP_S} {END_S} {FROM_S} 5u\nlinearize {shown}\nwrdata out {shown}")
    return [(t, v - sum(rest)) for t, v, *rest in rows]


def diode_and_rc(until: float) -> list[tuple[float, float]]:
    """Our own simulation of the article variant: the diode's exponential with its resistance, R_LP parallel to C_LP.

    Implicit Euler in steps of 1 us, the node solved by bisection: slow and simple.
    """
    R, C, dt = 2000.0, 2.2e-6, 1e-6
    saturation, series, thermal = 2.52e-9, 0.568, 1.752 * 8.617333e-5 * 300.15

    def current(volt: float) -> float:
        """Of diode and its resistance in series."""
        if volt <= 0:
            return saturation * (math.exp(volt / thermal) - 1)
        i = 0.0
        low, high = 0.0, volt / series
        for _ in range(40):
            i = 0.5 * (low + high)
            low, high = (i, high) if series * i + thermal * math.log1p(i / saturation) < volt else (low, i)
        return i

    v, found = 0.0, []
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
            found.append((n * dt, v))
    return found


def one_pole_of_half_waves(until: float) -> list[tuple[float, float]]:
    """Our own simulation of the precision variant: an ideal rectifier, one pole, exact between steps of 1 us."""
    dt = 1e-6
    keep, v, found = math.exp(-dt / 4.4e-3), 0.0, []
    for n in range(1, round(until / dt) + 1):
        v = keep * v + (1 - keep) * max(tone((n - 0.5) * dt), 0.0)
        if n % 20 == 0:
            found.append((n * dt, v))
    return found


CASES = [("article", "split"), ("article", "single"), ("precision", "split"), ("comparator", "single")]


@functools.cache
def ours(article: bool) -> dict[int, float]:
    """Our own simulation: sample's number -> envelope [V]."""
    return {round(t / STEP_S): v for t, v in (diode_and_rc if article else one_pole_of_half_waves)(END_S)}


@pytest.mark.parametrize(("variant", "supply"), CASES, ids=map(" ".join, CASES))
def test_transient_of_each_rectifier(written: Written, tmp_path: Path, variant: str, supply: str) -> None:
    """A tone through each: on a single supply the same signals, around its middle."""
    deck = (written(f"board.variant={variant}", f"board.supply={supply}") / "slip_filter.cir").read_text("utf-8")
    # R7 loads the envelope by 1 % of C_LP; left out on both sides.
    theirs = transient(tmp_path, deck, ("XU1", "R2 ", "R7 "), "0" if supply == "split" else "vmid")
    simulated = ours(variant == "article")
    pairs = [
        (v, simulated[round(t / STEP_S)]) for t, v in theirs if round(t / STEP_S) in simulated and t > FROM_S + STEP_S
    ]
    assert len(pairs) > 1500
    assert max(abs(a - b) for a, b in pairs) < 5e-3
    settled = [a for a, _ in pairs][len(pairs) // 2 :]
    # An ideal half wave's mean is 1/pi of its peak; the diode's dead zone takes a quarter of it.
    assert math.fsum(settled) / len(settled) == pytest.approx(0.24 if variant == "article" else 1 / math.pi, abs=0.01)


def test_the_rectifier_is_a_peak_detector_behind_a_dead_zone(tmp_path: Path) -> None:
    """100 Hz of 1 V ahead of the diode come out with 0.23 V of mean and 0.35 V of ripple; an ideal mean is 0.32 V."""
    _, deck = deck_of(tmp_path, [])
    alone = "\n".join(line for line in deck.splitlines() if not line.startswith(("XU1", "R2 ")))
    alone = alone.replace("\n.ac", "\nVtest filtered 0 sin(0 1 100)\n.ac") + "\n"
    rows = simulate(tmp_path, alone, "tran 20u 0.3 0.2 20u uic\nwrdata out v(envelope)")
    volts = [v for _, v in rows]
    mean = math.fsum(volts) / len(volts)
    assert mean == pytest.approx(0.23, abs=0.02)
    assert max(volts) - min(volts) == pytest.approx(0.35, abs=0.04)


@pytest.mark.parametrize("supply", ["split", "single"])
def test_the_comparator_switches_where_it_should(tmp_path: Path, supply: str) -> None:
    """The mean moves slowly up and down through both thresholds; the deck's SLIP is low in between."""
    design, deck = deck_of(tmp_path, ["board.variant=comparator", f"board.supply={supply}"])
    decision = board_values(design).decision
    assert decision is not None
    assert decision.mean_s == pytest.approx(0.015, rel=0.05)  # half of the article's window of 30 ms
    alone = "\n".join(line for line in deck.splitlines() if not line.startswith(("R18 ", "C17 ")))
    rest = "0" if supply == "split" else "vmid"
    alone = alone.replace("\n.ac", f"\nVmean mean {rest} pwl(0 0 1 0.04 2 0)\n.ac") + "\n"
    rows = simulate(tmp_path, alone, "tran 0.2m 2 0 0.2m\nwrdata out v(slip)")
    low = [t for t, v in rows if t > 0.01 and v < 1]
    on, off = 0.04 * low[0], 0.04 * (2 - low[-1])
    assert (on, off) == pytest.approx((decision.on_v, decision.off_v), abs=2e-4)
    # The design's threshold is the mean above which slip is ON; E24 misses it by a step of half a percent or two.
    assert on == pytest.approx(0.017, rel=0.02)
    assert off == pytest.approx(0.75 * 0.017, rel=0.04)
    assert all(v > 4.9 for t, v in rows if 0.04 * t < off - 1e-3)
