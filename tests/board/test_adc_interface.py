"""ADC interface: anti-aliasing poles by the circuit's equations and by ngspice, and the attenuation of aliases."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from tests.board.conftest import BoardFolder
from tests.board.ngspice import run_ngspice
from tests.designs import ARTICLE, load_article
from tests.oracles.filter_formulas import tactile_pin_transfer


def test_alias_attenuation_of_the_default_board() -> None:
    a = board_values(ARTICLE).aliasing
    assert (a.band_hz, a.nyquist_hz, a.alias_hz) == (201.0, 1000.0, 1799.0)
    assert a.lsb_v == 20 / 65536
    # A swing of 3.5 V against a step of 0.305 mV.
    assert a.required_db == pytest.approx(20 * math.log10(3.5 * 65536 / 20), rel=1e-12)
    assert a.one_lsb_tone_v * 10 ** (a.tactile_alias_db / 20) == pytest.approx(a.lsb_v, rel=1e-12)
    assert -1.7 < a.tactile_band_db < -1.5  # slip ends below 100 Hz in the embedded finger: 0.4 dB
    precision = board_values(load_article(["board.variant=precision"])).aliasing
    envelope_pole_db = -10 * math.log10(1 + (1000 / 36.17) ** 2)
    assert precision.envelope_nyquist_db - a.envelope_nyquist_db == pytest.approx(envelope_pole_db, abs=0.01)


