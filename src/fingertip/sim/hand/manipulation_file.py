"""A manipulation's file: which object, which grasp, what knocks on it, and how the hand answers.

The article's third configuration (III.C, figures 11, 16, 17): a robot's pin hits a grasped object at 8 cm/s. Masses,
grasps and that velocity are the article's; it gives no figure for anything else here, so all others are assumptions.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.errors import Issue
from fingertip.sim.scenes.scene import ACCELERATION_M_S2
from fingertip.sim.scenes.scene_sections import Sensing
from fingertip.sim.scenes.simulation_file import StrictFile

OUTPUTS = (
    "voltage_v",
    "force_n",
    "slip",
    "velocity_m_s",
    "closing_m",
    "command_m",
    "object_m",
    "pin_n",
    "envelope_v",
    "slip_pin_v",
)
"""Of each finger: voltage_v, sampled; force_n, true normal force; slip, true gross slip; velocity_m_s, of the object
over the pad; closing_m, of the finger; command_m, closing it was told; envelope_v and slip_pin_v, of its board, as in a
scene. Of the object: object_m, its way; pin_n, the pin's force."""


class Held(ParameterTable):
    """The object."""

    mass_kg: float = quantity(0.255, "kg", "The article's: 0.5, 0.255, 0.06, 0.02.", minimum=0.005, maximum=5)
    surface: Literal["smooth", "medium", "gross", "wood", "paper", "plastic"] = choice(
        "wood", "The article's four: wood, and a bottle of plastic (III.C)."
    )
    friction_spread: float = quantity(
        0.03, "", "The seed draws friction within this share of the surface's. Assumption.", minimum=0, maximum=0.5
    )
    length_m: float = quantity(
        0.05, "m", "Way after which the object has left the fingers. Assumption.", minimum=0.005, maximum=0.5
    )


class Grasp(ParameterTable):
    """Which fingers hold it, how hard before anything happens, and when."""

    kind: Literal["pinch", "power"] = choice("power", "pinch: thumb against index; power: thumb against four fingers.")
    force_n: float = quantity(
        0.0, "N", "The thumb's, before anything happens; 0: by the margins.", minimum=0, maximum=20
    )
    min_margin: float = quantity(
        1.1,
        "",
        "The seed draws the force, as a multiple of what just holds the weight, from here. Assumption.",
        above=0,
        maximum=20,
    )
    max_margin: float = quantity(
        1.2,
        "",
        "To here. Assumption; beyond mu_s / mu_c = 1.25 no knock frees an object for good.",
        above=0,
        maximum=20,
    )
    min_force_n: float = quantity(
        0.5, "N", "Least on the thumb: well beyond the sensor's turn-on. Assumption.", above=0, maximum=20
    )
    uneven: float = quantity(
        0.1,
        "",
        "The seed draws each opposing finger's share within this of its even one. Assumption.",
        minimum=0,
        maximum=0.9,
    )
    reach_m: float = quantity(0.03, "m", "Closing from open to touch. Assumption.", minimum=0.001, maximum=0.08)
    close_s: float = quantity(
        0.6, "s", "Time in which the hand is told to close. Assumption.", minimum=0.05, maximum=10
    )
    settle_s: float = quantity(0.5, "s", "Then whoever holds the object waits. Assumption.", minimum=0, maximum=60)
    let_go_s: float = quantity(0.5, "s", "Then the weight comes on in this time. Assumption.", minimum=0.01, maximum=10)
    after_s: float = quantity(
        2.0, "s", "Recorded after the pin has stopped; power grasps 1 s longer (article, III.C).", minimum=0, maximum=60
    )


class Knock(ParameterTable):
    """The robot's pin hits the object along the way in which it would slip; 0 m/s: it does not."""

    speed_m_s: float = quantity(0.08, "m/s", "Velocity (article: 0.08).", minimum=0, maximum=0.2)
    at_s: float = quantity(1.0, "s", "After the weight is on (article: 1 s between phases).", minimum=0, maximum=60)
    stroke_m: float = quantity(0.01, "m", "Way of the pin after it touched. Assumption.", minimum=0.001, maximum=0.1)
    stiffness_n_per_m: float = quantity(
        2000.0, "N/m", "Of pin and robot: a compliant arm. Assumption.", minimum=50, maximum=100000
    )
    damping_s_per_m: float = quantity(
        5.0, "s/m", "Hunt and Crossley's: returns 0.8 of 0.08 m/s. Assumption.", minimum=0, maximum=20
    )
    normal_share: float = quantity(
        0.05, "", "Share of its force that presses the object at the thumb. Assumption.", minimum=-0.5, maximum=0.5
    )


class Hand(ParameterTable):
    """From a command to the fingers' closing."""

    period_s: float = quantity(0.01, "s", "Between commands. Assumption.", minimum=0.0005, maximum=0.2)
    delay_s: float = quantity(0.02, "s", "From a command to the motors' answer. Assumption.", minimum=0, maximum=0.5)
    lag_s: float = quantity(0.03, "s", "Of the motors: first order. Assumption.", minimum=0.001, maximum=1)
    rate_m_s: float = quantity(
        0.1, "m/s", "Most velocity of closing: 60 mm in 0.6 s. Assumption.", minimum=0.005, maximum=1
    )
    max_force_n: float = quantity(15.0, "N", "A finger's tendon stalls at this. Assumption.", above=0, maximum=100)
    motor_n: float = quantity(
        0.01, "N", "Amplitude by which a motor at full velocity shakes its finger. Assumption.", minimum=0, maximum=5
    )
    motor_hz: float = quantity(45.0, "Hz", "Its frequency then. Assumption.", minimum=1, maximum=500)


class ManipulationFile(StrictFile):
    """One manipulation, validated: all issues at once.

    Raises
    ------
    TraceError
        With one sentence for each parameter out of bounds, unknown name or broken rule.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip manipulation")
    known_outputs: ClassVar[tuple[str, ...]] = OUTPUTS

    object: Held = Held()
    grasp: Grasp = Grasp()
    knock: Knock = Knock()
    hand: Hand = Hand()
    sensing: Sensing = Sensing()

    def __init__(self, **tables: Any) -> None:
        super().__init__(**tables)

    @property
    def fingers(self) -> tuple[str, ...]:
        """The fingers that touch, the thumb first."""
        opposing = ("index",) if self.grasp.kind == "pinch" else ("index", "middle", "ring", "little")
        return ("thumb", *opposing)

    def broken(self) -> Iterator[tuple[Issue, set[str]]]:
        """Rules between parameters that do not hold, and the parameters each reads."""
        yield from super().broken()
        grasp, knock = self.grasp, self.knock
        if grasp.min_margin > grasp.max_margin:
            sentence = f"{grasp.min_margin:g} is above grasp.max_margin; at most {grasp.max_margin:g}."
            yield Issue("grasp.min_margin", sentence), {"grasp.min_margin", "grasp.max_margin"}
        minimum = knock.speed_m_s**2 / (2 * ACCELERATION_M_S2)
        if knock.stroke_m < minimum:
            sentence = (
                f"{knock.stroke_m:g} m is too short to stop from {knock.speed_m_s:g} m/s; at least {minimum:g} m."
            )
            yield Issue("knock.stroke_m", sentence), {"knock.stroke_m", "knock.speed_m_s"}
        if self.sensing.jitter_s:
            sentence = "is not modelled with the hand in the loop; set it to 0."
            yield Issue("sensing.jitter_s", f"{self.sensing.jitter_s:g} s {sentence}"), {"sensing.jitter_s"}
