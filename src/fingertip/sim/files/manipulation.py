"""Manipulation file: the object, the grasp, the pin that hits the object, and the hand.

It describes the article's third configuration (III.C, figures 11, 16, 17): the pin of a robot hits a grasped object at
8 cm/s. Masses, grasps and this velocity are the article's. It gives no value for anything else here, so all other
values are assumptions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict, Field

from fingertip.catalogues.file_kinds import MANIPULATION, FileKind
from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue
from fingertip.foundation.validation import round_up
from fingertip.sim.files.schema import (
    ACCELERATION_M_S2,
    PathTables,
    SimulationFile,
    assumption,
    find_converter_issues,
)


class GraspedObject(ParameterTable):
    """Grasped object."""

    mass_kg: float = quantity(0.255, "kg", "Mass (article: 0.5, 0.255, 0.06, 0.02).", minimum=0.005, maximum=5)
    surface: Literal["smooth", "medium", "gross", "wood", "paper", "plastic"] = choice(
        "wood", "Surface (article, III.C: three wooden objects and a plastic bottle)."
    )
    friction_spread: float = assumption(
        0.03, "", "The seed draws friction within this relative range around the surface's.", minimum=0, maximum=0.5
    )
    patch_average: bool = Field(
        False, description="Whether pads average the surface profile over their contact patches, as real ones do."
    )
    length_m: float = assumption(
        0.05, "m", "Distance after which the object has left the fingers.", minimum=0.005, maximum=0.5
    )


class Grasp(ParameterTable):
    """Fingers that hold the object, their planned force, and the times of the grasp."""

    kind: Literal["pinch", "power"] = choice("power", "pinch: thumb against index; power: thumb against four fingers.")
    force_n: float = quantity(0.0, "N", "Planned holding force of the thumb; 0: by the margins.", minimum=0, maximum=20)
    min_margin: float = assumption(
        1.1,
        "",
        "Lower limit of the force that the seed draws, as a multiple of what just holds the weight.",
        above=0,
        maximum=20,
    )
    max_margin: float = quantity(
        1.2,
        "",
        "Upper limit. Assumption; above mu_s / mu_c = 1.25 no knock makes the object slide out.",
        above=0,
        maximum=20,
    )
    min_force_n: float = assumption(
        0.5, "N", "Minimum force of the thumb: well above the sensor's turn-on.", above=0, maximum=20
    )
    uneven: float = assumption(
        0.1,
        "",
        "The seed draws each opposing finger's share within this relative range around equal shares.",
        minimum=0,
        maximum=0.9,
    )
    reach_m: float = assumption(0.03, "m", "Closing from the open hand to the touch.", minimum=0.001, maximum=0.08)
    close_s: float = assumption(0.6, "s", "Time in which the commands close the hand.", minimum=0.05, maximum=10)
    settle_s: float = assumption(0.5, "s", "Wait before the object is let go.", minimum=0, maximum=60)
    let_go_s: float = assumption(0.5, "s", "Time in which the hand takes over the weight.", minimum=0.01, maximum=10)
    after_s: float = quantity(
        2.0,
        "s",
        "Recording time after the pin has stopped; power grasps 1 s longer (article, III.C).",
        minimum=0,
        maximum=60,
    )


class Knock(ParameterTable):
    """Impact of the robot's pin along the direction in which the object would slip; 0 m/s means none."""

    speed_m_s: float = quantity(0.08, "m/s", "Velocity of the pin (article: 0.08).", minimum=0, maximum=0.2)
    at_s: float = quantity(
        1.0,
        "s",
        "Time of the impact, after the hand carries the weight (article: 1 s between phases).",
        minimum=0,
        maximum=60,
    )
    stroke_m: float = assumption(0.01, "m", "Distance that the pin moves after the touch.", minimum=0.001, maximum=0.1)
    stiffness_n_per_m: float = assumption(
        2000.0, "N/m", "Stiffness of pin and robot: a compliant arm.", minimum=50, maximum=100000
    )
    damping_s_per_m: float = assumption(
        5.0, "s/m", "Hunt and Crossley's damping: an impact at 0.08 m/s rebounds with 0.8 of it.", minimum=0, maximum=20
    )
    normal_share: float = assumption(
        0.05, "", "Fraction of the pin's force that presses the object against the thumb.", minimum=-0.5, maximum=0.5
    )


class Hand(ParameterTable):
    """Response of the hand to commands."""

    period_s: float = assumption(0.01, "s", "Control period.", minimum=0.0005, maximum=0.2)
    delay_s: float = assumption(
        0.02, "s", "Delay from a command to the response of the motors.", minimum=0, maximum=0.5
    )
    lag_s: float = assumption(0.03, "s", "First-order lag of the motors.", minimum=0.001, maximum=1)
    rate_m_s: float = assumption(0.1, "m/s", "Maximum velocity of closing: 60 mm in 0.6 s.", minimum=0.005, maximum=1)
    max_force_n: float = assumption(15.0, "N", "Force at which a finger's tendon stalls.", above=0, maximum=100)
    motor_n: float = assumption(
        0.01, "N", "Amplitude with which a motor at full velocity shakes its finger.", minimum=0, maximum=5
    )
    motor_hz: float = assumption(45.0, "Hz", "Frequency of that vibration.", minimum=1, maximum=500)


class _ManipulationTables(SimulationFile):
    object: GraspedObject = GraspedObject()
    grasp: Grasp = Grasp()
    knock: Knock = Knock()
    hand: Hand = Hand()


class ManipulationFile(PathTables, _ManipulationTables):
    """One validated manipulation; a faulty one reports all its issues at once.

    Raises
    ------
    TraceError
        With one issue for each parameter out of bounds, unknown name or broken rule.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip manipulation")
    file_kind: ClassVar[FileKind] = MANIPULATION
    options: ClassVar[Mapping[str, Sequence[str]]] = {
        "surface": ["object.surface"],
        "speed_m_s": ["knock.speed_m_s"],
        "force_n": ["grasp.force_n"],
    }

    def __init__(self, /, **tables: Any) -> None:
        super().__init__(**tables)

    @property
    def fingers(self) -> tuple[str, ...]:
        """Names of the fingers that touch, the thumb first."""
        opposing = ("index",) if self.grasp.kind == "pinch" else ("index", "middle", "ring", "little")
        return ("thumb", *opposing)

    def find_rule_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule between parameters, with the names of the parameters it reads."""
        yield from super().find_rule_issues()
        grasp, knock = self.grasp, self.knock
        if grasp.min_margin > grasp.max_margin:
            message = f"{grasp.min_margin:g} is above grasp.max_margin; at most {grasp.max_margin:.12g}."
            yield Issue("grasp.min_margin", message), {"grasp.min_margin", "grasp.max_margin"}
        minimum = knock.speed_m_s**2 / (2 * ACCELERATION_M_S2)
        if knock.stroke_m < minimum:
            what = f"{knock.stroke_m:g} m is too short to stop from {knock.speed_m_s:g} m/s"
            message = f"{what}; at least {round_up(minimum):g} m."
            yield Issue("knock.stroke_m", message), {"knock.stroke_m", "knock.speed_m_s"}
        yield from find_converter_issues(self.converter)
