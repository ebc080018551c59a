"""Start of a robot's motion, and how well encoders know it: the article reads its robot's at 100 Hz (section III.C)."""

from __future__ import annotations

ENCODER_HZ = 100.0
"""Rate at which the encoders are read [Hz] (article, section III.C)."""


def encoder_band_s(motion_s: float) -> tuple[float, float]:
    """Interval in which encoders first show a motion that begins at `motion_s` [s]: one of their periods.

    Every picture and table takes the article's uncertainty from here. Friction in the robot and the encoders' step make
    it later still.
    """
    return motion_s, motion_s + 1 / ENCODER_HZ


def encoder_delay_band_s(delay_s: float) -> tuple[float, float]:
    """Shortest and longest delay that encoders show for a true delay since the motion [s]."""
    first_s, last_s = encoder_band_s(0.0)
    return delay_s - last_s, delay_s - first_s


def format_delay_band(delay_s: float) -> str:
    """Format the delays that encoders show for a true delay since the motion, such as ``15.5-25.5 ms``."""
    low_s, high_s = encoder_delay_band_s(delay_s)
    return f"{1000 * low_s:.1f}-{1000 * high_s:.1f} ms"


ENCODER_NOTE = (
    f"encoders at {ENCODER_HZ:g} Hz, as the article's, know when it moved to {1000 / ENCODER_HZ:g} ms: their delays "
    "are up to so much shorter"
)
"""Note of tables below delays since the robot moved."""
BAND_LABEL = f"robot starts, known to {1000 / ENCODER_HZ:g} ms (encoders, {ENCODER_HZ:g} Hz)"
"""Name of the band in the legends of pictures."""
