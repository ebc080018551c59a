"""Force beside slip: read off the curve of the sensor, with its
interval, and without any say in what is slip.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.detection.recordings import find_force_scale
from fingertip.sim.signal.bridge import HYSTERESIS, Bridge
from fingertip.slip.detection_results import as_data, as_text
from fingertip.slip.force import MEAN_S
from fingertip.slip.scored_detection import detect
from fingertip.slip.traces.trace import Trace

CALIBRATED = Design.load(
    "fsr400", changes={"force_curve.curve": "calibrated", "force_curve.interval_factor": 1.3}
)


@pytest.mark.parametrize(("design", "factor"), [(Design(), 8.0), (CALIBRATED, 1.3)])
def test_a_force_lies_within_its_interval_also_while_it_falls(
    design: Design, factor: float
) -> None:
    scale = find_force_scale(design)
    assert scale is not None
    for force_n in (1.0, 2.0, 5.0):
        forces_n = np.array([force_n, force_n * (1 + HYSTERESIS)])
        rising_v, falling_v = Bridge.of_board(design).voltage_v(forces_n).tolist()
        for volts in (rising_v, falling_v):
            found = scale.read(volts)
            assert found.low_n <= force_n <= found.high_n
            assert found.high_n == pytest.approx(factor * found.force_n)
            assert found.low_n == pytest.approx(found.force_n / factor / (1 + HYSTERESIS))
    open_v = float(scale.volts[0])
    most_v = float(scale.volts[-1])
    assert scale.read(open_v).low_n == 0.0
    assert scale.read(open_v).high_n == factor * scale.known_n[0]
    assert math.isinf(scale.read(most_v).high_n)


def test_an_unknown_sensor_has_no_force() -> None:
    assert find_force_scale(Design.load("fsr400", changes=["sensor.model=custom"])) is None


def test_the_force_stands_beside_each_interval_and_changes_no_verdict() -> None:
    """The mean voltage of 20 ms before ON is read; a hand that starts
    while it touches something reads the same.
    """
    design = Design()
    rate_hz = 2000.0
    time_s = np.arange(4000) / rate_hz
    noise = np.random.default_rng(1).normal(0.0, 2e-4, 4000)
    at_v = float(Bridge.of_board(design).voltage_v(np.array([2.0]))[0])
    slides = (time_s > 1.0) & (time_s < 1.5)
    buzz = slides * 0.02 * np.random.default_rng(2).normal(0.0, 1.0, 4000)
    found = detect(Trace(time_s, at_v + noise + buzz), design, "fast")
    assert found.forces is None
    beside = replace(found, scale=find_force_scale(design))
    assert beside.forces is not None
    first = round(beside.intervals[0].onset_s * rate_hz)
    mean_v = float(found.trace.voltage_v[first + 1 - round(MEAN_S * rate_hz) : first + 1].mean())
    assert beside.scale is not None
    assert beside.forces[0].force_n == pytest.approx(beside.scale.read(mean_v).force_n, rel=0.01)
    assert as_text(beside).count(f", at {beside.forces[0].describe()}") >= 1
    with_force, without = (as_data(one, None)["intervals"][0].keys() for one in (beside, found))
    assert with_force - without == {"force_n", "force_interval_n"}
    assert beside.intervals == found.intervals
