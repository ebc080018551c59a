"""What lies ahead of the converter: its poles by the circuit itself and by ngspice, and what they keep from folding."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.equations import equations
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from tests.board.conftest import Written
from tests.board.ngspice import simulate

RATES = (1000.0, 2000.0, 5000.0, 20000.0)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("series", ["E12", "E96"])
def test_the_poles_follow_the_rate(rate: float, series: str) -> None:
    design = Design.load(changes=[f"detector.sample_rate_hz={rate}", f"board.series={series}"])
    values = board_values(design)
    f = np.array([1.0, 50.0, rate / 4, rate / 2, rate])
    system = equations(board_circuit(values), 3e6, 0.0, "TACTILE")
    found = system.response(f, "ADC_TACTILE")
    for hz, gain in zip(f, found, strict=True):
        assert gain == pytest.approx(values.converter.raw(float(hz)), rel=1e-9)
    # Two near poles at a quarter of the rate lose 6 dB there; a single one would lose 3.
    assert 20 * math.log10(abs(found[2])) == pytest.approx(-6.4, abs=0.8)
    assert values.alias.raw_nyquist_db == pytest.approx(20 * math.log10(abs(found[3])), abs=1e-9)
    assert values.alias.raw_nyquist_db < -13
    assert values.alias.nyquist_hz == rate / 2


def test_the_figures_of_the_default_board() -> None:
    a = board_values(Design()).alias
    assert (a.band_hz, a.nyquist_hz, a.alias_hz) == (201.0, 1000.0, 1799.0)
    assert a.step_v == 20 / 65536
    # 3.5 V of swing against a step of 0.305 mV; what is hidden becomes a step.
    assert a.needed_db == pytest.approx(20 * math.log10(3.5 * 65536 / 20), rel=1e-12)
    assert a.hidden_v * 10 ** (a.raw_alias_db / 20) == pytest.approx(a.step_v, rel=1e-12)
    assert -1.7 < a.raw_band_db < -1.5  # slip ends below 100 Hz in the embedded finger: 0.4 dB
    precise = board_values(Design.load(changes=["board.variant=precision"])).alias
    own = -10 * math.log10(1 + (1000 / 36.17) ** 2)
    assert precise.envelope_nyquist_db - a.envelope_nyquist_db == pytest.approx(own, abs=0.01)


@pytest.mark.parametrize("name", ["article_split", "comparator_single"])
def test_the_deck_has_the_same_poles(written: Written, tmp_path: Path, name: str) -> None:
    folder = written(*VARIANTS[name].changes)
    values = board_values(Design.load(changes=VARIANTS[name].changes))
    rows = simulate(
        tmp_path, (folder / "slip_filter.cir").read_text("utf-8"),
        "ac dec 20 1 10k\nwrdata out vr(tactile) vi(tactile) vr(adc_tactile) vi(adc_tactile)",
    )  # fmt: skip
    for f, tr, ti, ar, ai in rows:
        # The clamp's 10 pF and its leakage load the pin a little.
        assert complex(ar, ai) / complex(tr, ti) == pytest.approx(values.converter.raw(f), rel=3e-3)
