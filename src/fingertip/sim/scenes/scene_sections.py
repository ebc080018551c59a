"""The tables of a scene file. Every parameter stands here once: default, unit, bounds, meaning.

Every table has neutral defaults, so a file names only what happens: no distance, no slide; no force, no tap. Figures
come with their source where there is one; the others are assumptions, and say so.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from fingertip.design.parameters import ParameterTable, choice, quantity


class Contact(ParameterTable):
    """The surface, and how the pad answers it."""

    surface: Literal["smooth", "medium", "gross", "wood", "paper", "plastic"] = choice(
        "medium", "One of the article's six (III.C)."
    )
    length_m: float = quantity(0.1, "m", "Length of the surface. Assumption.", above=0, maximum=1)
    resonance_hz: float = quantity(
        90.0,
        "Hz",
        "Normal resonance at 1 N: 90 embedded, 230 the bare sensor (article, fig. 2).",
        minimum=20,
        maximum=500,
    )
    bristles: Literal["plain", "elasto_plastic"] = choice(
        "plain", "LuGre as published, or without its creep below breakaway."
    )
    feedback: bool = Field(False, description="Whether vibration of the load acts back on friction.")


class Hold(ParameterTable):
    """The hand: how it presses, and how hard."""

    mode: Literal["press", "grasp"] = choice("press", "Down to a depth (sliding finger), or up to a force (grasp).")
    min_force_n: float = quantity(0.2, "N", "The seed draws the force from here (article, III.C).", above=0, maximum=4)
    max_force_n: float = quantity(2.0, "N", "To here; the lift of 5 cm ends contacts of up to 4 N.", above=0, maximum=4)
    share: float = quantity(
        1.0,
        "",
        "Part of a grasp's force on this finger: thumb 1, each of two fingers against it 0.5.",
        above=0,
        maximum=1,
    )
    close_s: float = quantity(0.4, "s", "A grasp's force rises in this time. Assumption.", minimum=0.02, maximum=10)
    wait_s: float = quantity(1.0, "s", "Between the phases (article, III.C).", minimum=0, maximum=60)
    min_s: float = quantity(0.0, "s", "Hold for this long at least.", minimum=0, maximum=600)
    release: bool = Field(True, description="Whether the finger lifts (press) or the grasp opens at the end.")
    after_s: float = quantity(0.2, "s", "Recorded at the end. Assumption.", minimum=0, maximum=60)


class Slide(ParameterTable):
    """The surface passes under the finger; 0 m: it does not."""

    distance_m: float = quantity(0.0, "m", "Way (article: 0.04).", minimum=0, maximum=1)
    speed_m_s: float = quantity(0.04, "m/s", "Peak (article: 0.04, 0.06, 0.08).", minimum=0.005, maximum=0.2)
    acceleration_m_s2: float = quantity(1.0, "m/s2", "Of the trapezoid's ends. Assumption.", minimum=0.05, maximum=20)


class LoadChange(ParameterTable):
    """The holding force changes once; 0 N: it does not."""

    by_n: float = quantity(0.0, "N", "Added to the force on this finger.", minimum=-4, maximum=4)
    rise_s: float = quantity(0.1, "s", "In this time. Assumption.", minimum=0.001, maximum=10)
    at_s: float = quantity(1.0, "s", "After the force is reached. Assumption.", minimum=0, maximum=600)


class Tap(ParameterTable):
    """Something knocks on the held object; 0 N: nothing does."""

    force_n: float = quantity(0.0, "N", "Peak of the force.", minimum=0, maximum=50)
    rise_s: float = quantity(
        0.004, "s", "Rise, and fall, of a tap: 2 to 10 ms. Assumption.", minimum=0.001, maximum=0.1
    )
    at_s: float = quantity(1.0, "s", "The first, after the force is reached. Assumption.", minimum=0, maximum=600)
    count: int = quantity(1, "", "How many. Assumption.", minimum=1, maximum=1000)
    interval_s: float = quantity(0.5, "s", "From one to the next. Assumption.", minimum=0.01, maximum=600)


class Motor(ParameterTable):
    """The hand's motors shake the finger; 0 N: they stand still."""

    force_n: float = quantity(0.0, "N", "Amplitude of the fundamental.", minimum=0, maximum=5)
    frequency_hz: float = quantity(45.0, "Hz", "Of the fundamental. Assumption.", minimum=1, maximum=500)
    harmonic: float = quantity(
        0.3, "", "Amplitude of the second harmonic, as a share. Assumption.", minimum=0, maximum=1
    )
    at_s: float = quantity(1.0, "s", "After the force is reached. Assumption.", minimum=0, maximum=600)
    duration_s: float = quantity(1.0, "s", "For this long. Assumption.", minimum=0.01, maximum=600)


class Drift(ParameterTable):
    """The sensor's slow changes."""

    share_per_decade: float = quantity(
        0.0, "", "Creep: force shown more per decade of time (data sheet: below 0.05).", minimum=0, maximum=0.2
    )
    volt_per_s: float = quantity(
        0.0, "V/s", "Of the amplifier, with temperature. Assumption.", minimum=-0.1, maximum=0.1
    )


class Cable(ParameterTable):
    """Somebody touches the cable; 0 V: nobody does."""

    step_v: float = quantity(0.0, "V", "Jump when the touch begins, and back when it ends.", minimum=-1, maximum=1)
    decay_s: float = quantity(0.05, "s", "The jump decays in this time. Assumption.", minimum=0.001, maximum=10)
    hum_v: float = quantity(0.0, "V", "Amplitude of the mains' hum during the touch.", minimum=0, maximum=1)
    hum_hz: float = quantity(50.0, "Hz", "Of the mains.", minimum=16, maximum=60)
    at_s: float = quantity(1.0, "s", "After the force is reached. Assumption.", minimum=0, maximum=600)
    duration_s: float = quantity(0.5, "s", "For this long. Assumption.", minimum=0.01, maximum=600)


class Sensing(ParameterTable):
    """From force to voltage."""

    bridge: Literal["board", "article"] = choice(
        "board", "The design's bridge and amplifier; or, to compare, a curve through the article's voltages."
    )
    amplifiers: Literal["ideal", "rails", "gain_bandwidth"] = choice(
        "ideal", "Of the filter: ideal, stopped at their rails, or of the design's gain-bandwidth product."
    )
    noise: bool = Field(True, description="Whether the board's amplifiers and the converter add theirs.")
    jitter_s: float = quantity(
        0.0,
        "s",
        "Of the converter's instants, rms; 0: none (assumption: a data acquisition card's).",
        minimum=0,
        maximum=1e-3,
    )
