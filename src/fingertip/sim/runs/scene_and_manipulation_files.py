"""Scene and manipulation files: what happens to one fingertip or to a grasped object, and which
signals to record.

Every parameter stands here once, with default, unit, bounds and meaning. All defaults of a scene
are neutral, so a file names only what happens: no distance means no slide, no force means no knock.
Values from a source name it; the others are marked as assumptions.

A manipulation describes the article's third configuration (III.C, figures 11, 16, 17): the pin of a
robot hits a grasped object at 8 cm/s. Masses, grasps and this velocity are the article's. It gives
no value for anything else there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

from pydantic import ConfigDict, Field

from fingertip.catalogues.file_kinds import MANIPULATION, SCENE, FileKind
from fingertip.design import Design
from fingertip.design.parameters import Above, ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue
from fingertip.foundation.validation import round_down, round_up
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import Pad
from fingertip.pad.touch import Pose
from fingertip.sim.contact.surface_files import (
    ARTICLE_SURFACES,
    SurfaceTable,
    find_pitch_issues,
    find_surface_issues,
)
from fingertip.sim.runs.pose import MountTable, ScenePose
from fingertip.sim.runs.tremor_and_servo import Servo, Tremor
from fingertip.sim.signal.parameters import (
    ACCELERATION_M_S2,
    PathTables,
    SimulationFile,
    assumption,
)

MIN_STIFFNESS_N_PER_M = 100.0
"""Smallest stiffness of an object that yields [N/m]: that of the hand. 20 N dent it by 20 cm."""
MAX_TAPS_S = 3600.0
"""Longest time from the first knock to the last one [s]. A trace of it has 250 MB at 2 kHz."""


class Contact(ParameterTable):
    """Surface, and response of the pad to it."""

    surface: str = choice(
        "medium", f"Surface by name; the article's (III.C) are {', '.join(ARTICLE_SURFACES)}."
    )
    length_m: float = assumption(0.1, "m", (Above(0), 1), "Length of the surface.")
    bristles: Literal["plain", "elasto_plastic"] = choice(
        "plain", "LuGre friction as published, or without its creep below breakaway."
    )
    feedback: bool = Field(
        False, description="Whether vibration of the load acts back on friction."
    )
    patch_average: bool = Field(
        False,
        description="Whether the pad averages the surface profile over its contact patch, as a "
        "real one does.",
    )
    stick_slip: bool = Field(
        False,
        description="Whether friction falls with speed so much that the pad swings on its mount, "
        "and sticks at moments "
        "under a firm grip. It does so at 0.03 to 0.08 m/s; slower and faster slides are "
        "smoother. Assumption.",
    )


class Hold(ParameterTable):
    """Grip of the hand: its mode and its force."""

    mode: Literal["press", "grasp"] = choice(
        "press", "Press to a depth (sliding finger), or grasp with a force."
    )
    min_force_n: float = quantity(
        0.2, "N", (0.001, 4), "Lower limit of the force that the seed draws (article, III.C)."
    )
    max_force_n: float = quantity(
        2.0, "N", (0.001, 4), "Upper limit; the lift of 5 cm ends contacts of up to 4 N."
    )
    share: float = quantity(
        1.0,
        "",
        (0.001, 1),
        "Fraction of a grasp's force on this finger: thumb 1, each of two opposing fingers 0.5.",
    )
    close_s: float = assumption(0.4, "s", (0.02, 10), "Time in which the force of a grasp rises.")
    wait_s: float = quantity(1.0, "s", (0, 60), "Wait between the phases (article, III.C).")
    trigger_v: float = quantity(
        0.0,
        "V",
        (0, 1),
        "Change of the tactile voltage, without noise, from which the wait before the slide "
        "counts (article, III.C, "
        "sliding surface); 0, or one that is not reached: from the holding force on.",
    )
    min_s: float = quantity(0.0, "s", (0, 600), "Minimum holding time.")
    release: bool = Field(
        True, description="Whether the finger lifts (press) or the grasp opens at the end."
    )
    after_s: float = assumption(0.2, "s", (0, 60), "Recording time after the end.")


_MIN_SPEED_M_S = 0.005
DIRECTIONS = {"tip": 1, "base": -1, "side": 0}
"""Direction of a slide -> its part towards the tip."""


class Slide(ParameterTable):
    """Slide of the surface under the finger; 0 m means none."""

    distance_m: float = quantity(0.0, "m", (0, 1), "Distance (article: 0.04).")
    speed_m_s: float = quantity(
        0.04, "m/s", (_MIN_SPEED_M_S, 0.2), "Peak velocity (article: 0.04, 0.06, 0.08)."
    )
    acceleration_m_s2: float = assumption(
        1.0, "m/s2", (0.05, 20), "Acceleration of the trapezoidal velocity profile."
    )
    towards: Literal["tip", "base", "side"] = choice(
        "tip",
        "Where the finger moves to; the surface drags its skin the other way, and a drag across "
        "is not felt.",
    )
    moves: int = assumption(
        1, "", (1, 50), "Number of equal moves that make up the distance: slips with pauses."
    )
    pause_s: float = assumption(0.2, "s", (0.02, 10), "Pause between two moves.")


class LoadChange(ParameterTable):
    """One change of the holding force; 0 N means none."""

    by_n: float = quantity(0.0, "N", (-4, 4), "Force added on this finger.")
    rise_s: float = assumption(0.1, "s", (0.001, 10), "Duration of the change.")
    at_s: float = assumption(1.0, "s", (0, 600), "Start, after the holding force is reached.")


class Tap(ParameterTable):
    """Knocks on the held object, called taps in scene files; 0 N means none."""

    force_n: float = quantity(0.0, "N", (0, 50), "Peak force.")
    rise_s: float = assumption(
        0.004, "s", (0.001, 0.1), "Rise time, and fall time, of a knock: 2 to 10 ms."
    )
    at_s: float = assumption(
        1.0, "s", (0, 600), "Time of the first knock, after the holding force is reached."
    )
    count: int = assumption(1, "", (1, 1000), "Number of knocks.")
    interval_s: float = assumption(0.5, "s", (0.01, 600), "Time from one knock to the next.")


class Motor(ParameterTable):
    """Vibration of the hand's motors; 0 N means none."""

    force_n: float = quantity(0.0, "N", (0, 5), "Amplitude of the fundamental.")
    frequency_hz: float = assumption(45.0, "Hz", (1, 500), "Frequency of the fundamental.")
    harmonic: float = assumption(
        0.3, "", (0, 1), "Amplitude of the second harmonic, relative to the fundamental."
    )
    at_s: float = assumption(1.0, "s", (0, 600), "Start, after the holding force is reached.")
    duration_s: float = assumption(1.0, "s", (0.01, 600), "Duration.")


class _SceneTables(SimulationFile):
    contact: Contact = Contact()
    surface: SurfaceTable = SurfaceTable()
    mount: MountTable = MountTable()
    pose: ScenePose = ScenePose()
    hold: Hold = Hold()
    slide: Slide = Slide()
    load_change: LoadChange = LoadChange()
    tremor: Tremor = Tremor()
    servo: Servo = Servo()
    tap: Tap = Tap()
    motor: Motor = Motor()


class SceneFile(PathTables, _SceneTables):
    """One validated scene. Raises TraceError with all parameters out of bounds, unknown names and
    broken rules.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        title="fingertip scene",
    )
    file_kind: ClassVar[FileKind] = SCENE
    options: ClassVar[Mapping[str, Sequence[str]]] = {
        "surface": ["contact.surface"],
        "speed_m_s": ["slide.speed_m_s"],
        "force_n": ["hold.min_force_n", "hold.max_force_n"],
    }

    def __init__(self, /, **tables: Any) -> None:
        super().__init__(**tables)

    def find_design_issues(self, design: Design, seed: int) -> Iterator[Issue]:
        """Yield the reasons why this cannot be simulated with a design and a seed."""
        yield from super().find_design_issues(design, seed)
        yield from self.pose.find_issues(PadForm.of_design(design))
        rate_hz = design.detector.sample_rate_hz

        if self.slide.distance_m:
            yield from find_pitch_issues(
                self.contact.surface, self.surface, self.slide.speed_m_s, rate_hz
            )

        half = rate_hz / 2
        if self.motor.force_n and self.motor.frequency_hz >= half:
            what = f"{self.motor.frequency_hz:g} Hz is not below half of detector.sample_rate_hz"
            yield Issue("motor.frequency_hz", f"{what}; below {half:g} Hz.")

    def complete(self) -> Self:
        """Copy with the values of the named surface and of the kind of mount in place of those that
        keep them.
        """
        mount = self.mount.model_copy(update=vars(self.mount.backing))
        return self.model_copy(
            update={"surface": self.surface.complete(self.contact.surface), "mount": mount}
        )

    def draw_pose(self, design: Design, seed: int) -> Pose:
        return self.pose.draw(PadForm.of_design(design), seed)

    def draw_pad(self, design: Design, seed: int) -> Pad:
        """Draw the pose, and build the pad of a design in it. Raises TraceError."""
        return Pad.from_design(design, self.draw_pose(design, seed), self.mount.backing)

    def find_rule_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule between parameters, with the names of the parameters it reads."""
        yield from super().find_rule_issues()
        yield from self.mount.find_issues()
        hold = self.hold
        slide = self.slide
        tap = self.tap

        if hold.min_force_n > hold.max_force_n:
            message = (
                f"{hold.min_force_n:g} N is above hold.max_force_n; at most "
                f"{hold.max_force_n:.12g} N."
            )
            yield Issue("hold.min_force_n", message), {"hold.min_force_n", "hold.max_force_n"}

        yield from self.converter.find_issues()
        yield from find_surface_issues(
            "contact.surface",
            name=self.contact.surface,
            table=self.surface,
            path_field="slide.distance_m",
            path_m=slide.distance_m,
        )
        if slide.distance_m > self.contact.length_m:
            message = (
                f"{slide.distance_m} m is longer than contact.length_m; set "
                f"contact.length_m={slide.distance_m}."
            )
            yield Issue("slide.distance_m", message), {"slide.distance_m", "contact.length_m"}

        reached = math.sqrt(slide.acceleration_m_s2 * slide.distance_m / slide.moves)
        if slide.distance_m and reached < _MIN_SPEED_M_S:
            least = 1.01 * slide.moves * _MIN_SPEED_M_S**2 / slide.acceleration_m_s2
            message = (
                f"{slide.distance_m:g} m is too short to reach {_MIN_SPEED_M_S:g} m/s at "
                f"{slide.acceleration_m_s2:g} "
                f"m/s2; set slide.distance_m={least:.3g}, slide.speed_m_s={_MIN_SPEED_M_S:g} and "
                f"contact.length_m={max(least, self.contact.length_m):.3g}, or slide.distance_m=0."
            )
            yield (
                Issue("slide.distance_m", message),
                {"slide.distance_m", "slide.acceleration_m_s2", "slide.moves"},
            )
        elif slide.distance_m and slide.speed_m_s > reached * (1 + 1e-9):
            message = (
                f"{slide.speed_m_s:g} m/s is not reached within {slide.distance_m:g} m at "
                f"{slide.acceleration_m_s2:g} m/s2; at most {round_down(reached):g} m/s."
            )
            fields = {
                "slide.speed_m_s",
                "slide.distance_m",
                "slide.acceleration_m_s2",
                "slide.moves",
            }
            yield Issue("slide.speed_m_s", message), fields

        if self.servo.step_n and self.servo.interval_s < self.servo.rise_s:
            message = (
                f"{self.servo.interval_s:g} s lets steps overlap; at least "
                f"{self.servo.rise_s:.12g} s."
            )
            yield (
                Issue("servo.interval_s", message),
                {"servo.interval_s", "servo.rise_s", "servo.step_n"},
            )

        if self.contact.stick_slip and self.contact.bristles == "elasto_plastic":
            message = (
                "is modelled with plain bristles only; set contact.bristles=plain or "
                "contact.stick_slip=false."
            )
            yield Issue("contact.stick_slip", message), {"contact.stick_slip", "contact.bristles"}

        if tap.force_n and tap.count > 1 and tap.interval_s < 2 * tap.rise_s:
            message = f"{tap.interval_s:g} s lets taps overlap; at least {2 * tap.rise_s:.12g} s."
            yield Issue("tap.interval_s", message), {"tap.interval_s", "tap.rise_s", "tap.count"}

        if tap.force_n and (tap.count - 1) * tap.interval_s > MAX_TAPS_S:
            most = round_down(MAX_TAPS_S / (tap.count - 1))
            message = (
                f"{tap.interval_s:g} s lets {tap.count} taps last more than {MAX_TAPS_S:g} "
                f"s; at most {most:g} s."
            )
            yield Issue("tap.interval_s", message), {"tap.interval_s", "tap.count"}

        minimum = hold.min_force_n * (hold.share if hold.mode == "grasp" else 1.0)
        if self.load_change.by_n <= -minimum:
            message = (
                f"{self.load_change.by_n:g} N ends the contact; it must be above {-minimum:g} N; "
            )
            message += "to end the contact, set load_change.by_n=0 and hold.release=true."
            yield (
                Issue("load_change.by_n", message),
                {"load_change.by_n", "hold.min_force_n", "hold.share"},
            )


class GraspedObject(ParameterTable):
    """Grasped object."""

    mass_kg: float = quantity(0.255, "kg", (0.005, 5), "Mass (article: 0.5, 0.255, 0.06, 0.02).")
    surface: str = choice(
        "wood", "Surface by name (article, III.C: three wooden objects and a plastic bottle)."
    )
    stiffness_n_per_m: float = quantity(
        0.0,
        "N/m",
        (0, 1e6),
        "Stiffness of the wall under each finger, in series with its pad; 0: rigid.",
    )
    friction_spread: float = assumption(
        0.03,
        "",
        (0, 0.5),
        "The seed draws friction within this relative range around the surface's.",
    )
    patch_average: bool = Field(
        False,
        description="Whether pads average the surface profile over their contact patches, as real "
        "ones do.",
    )
    length_m: float = assumption(
        0.05, "m", (0.005, 0.5), "Distance after which the object has left the fingers."
    )


class Grasp(ParameterTable):
    """Fingers that hold the object, their planned force, and the times of the grasp."""

    kind: Literal["pinch", "tri", "power"] = choice(
        "power",
        "pinch: thumb against index; tri: against index and middle finger; power: against four "
        "fingers.",
    )
    force_n: float = quantity(
        0.0, "N", (0, 20), "Planned holding force of the thumb; 0: by the margins."
    )
    min_margin: float = assumption(
        1.1,
        "",
        (Above(0), 20),
        "Lower limit of the force that the seed draws, as a multiple of what just holds the "
        "weight.",
    )
    max_margin: float = quantity(
        1.2,
        "",
        (Above(0), 20),
        "Upper limit. Assumption; above mu_s / mu_c = 1.25 no knock makes the object slide out.",
    )
    min_force_n: float = assumption(
        0.5, "N", (Above(0), 20), "Minimum force of the thumb: well above the sensor's turn-on."
    )
    max_force_n: float = quantity(
        3.5,
        "N",
        (Above(0), 20),
        "Upper limit of the force that the seed draws where the robot carries the object "
        "(article, IV.A: above 3 N).",
    )
    uneven: float = assumption(
        0.1,
        "",
        (0, 0.9),
        "The seed draws each opposing finger's share within this relative range around equal "
        "shares.",
    )
    reach_m: float = assumption(
        0.03, "m", (0.001, 0.08), "Closing from the open hand to the touch."
    )
    close_s: float = assumption(0.6, "s", (0.05, 10), "Time in which the commands close the hand.")
    settle_s: float = assumption(0.5, "s", (0, 60), "Wait before the object is let go.")
    let_go_s: float = assumption(
        0.5, "s", (0.01, 10), "Time in which the hand takes over the weight."
    )
    after_s: float = quantity(
        2.0,
        "s",
        (0, 60),
        "Recording time after the pin has stopped; power grasps 1 s longer (article, III.C).",
    )


class Knock(ParameterTable):
    """Impact of the robot's pin along the direction in which the object would slip; 0 m/s means
    none.

    A pin that is attached carries the object instead: it bears the weight, and pulls it through the
    fingers.
    """

    attached: bool = Field(
        False, description="Whether the pin is attached to the object (article: sliding surface)."
    )
    trigger_v: float = quantity(
        0.0,
        "V",
        (0, 1),
        "Change of the thumb's tactile voltage, without noise, from which at_s counts (article, "
        "III.C); 0, or one that "
        "is not reached: from the moment at which the hand carries the weight.",
    )
    speed_m_s: float = quantity(0.08, "m/s", (0, 0.2), "Velocity of the pin (article: 0.08).")
    at_s: float = quantity(
        1.0,
        "s",
        (0, 60),
        "Time of the impact or the pull, after the hand carries the weight or after the trigger "
        "(article: 1 s between phases).",
    )
    stroke_m: float = assumption(
        0.01, "m", (0.001, 0.1), "Distance that the pin moves after the touch."
    )
    stiffness_n_per_m: float = assumption(
        2000.0, "N/m", (50, 100000), "Stiffness of pin and robot: a compliant arm."
    )
    damping_s_per_m: float = assumption(
        5.0,
        "s/m",
        (0, 20),
        "Hunt and Crossley's damping: an impact at 0.08 m/s rebounds with 0.8 of it.",
    )
    normal_share: float = assumption(
        0.05,
        "",
        (-0.5, 0.5),
        "Fraction of the pin's force that presses the object against the thumb.",
    )


class Hand(ParameterTable):
    """Response of the hand to commands."""

    period_s: float = assumption(0.01, "s", (0.0005, 0.2), "Control period.")
    delay_s: float = assumption(
        0.02, "s", (0, 0.5), "Delay from a command to the response of the motors."
    )
    lag_s: float = assumption(0.03, "s", (0.001, 1), "First-order lag of the motors.")
    rate_m_s: float = assumption(
        0.1, "m/s", (0.005, 1), "Maximum velocity of closing: 60 mm in 0.6 s."
    )
    max_force_n: float = assumption(
        15.0, "N", (Above(0), 100), "Force at which a finger's tendon stalls."
    )
    motor_n: float = assumption(
        0.01, "N", (0, 5), "Amplitude with which a motor at full velocity shakes its finger."
    )
    motor_hz: float = assumption(45.0, "Hz", (1, 500), "Frequency of that vibration.")

    def count_points(self, rate_hz: float) -> tuple[int, int]:
        """Control period and delay as numbers of points of a grid."""
        return max(1, round(self.period_s * rate_hz)), round(self.delay_s * rate_hz)


class _ManipulationTables(SimulationFile):
    object: GraspedObject = GraspedObject()
    surface: SurfaceTable = SurfaceTable()
    grasp: Grasp = Grasp()
    knock: Knock = Knock()
    hand: Hand = Hand()


class ManipulationFile(PathTables, _ManipulationTables):
    """One validated manipulation. Raises TraceError as `SceneFile` does."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        title="fingertip manipulation",
    )
    file_kind: ClassVar[FileKind] = MANIPULATION
    options: ClassVar[Mapping[str, Sequence[str]]] = {
        "surface": ["object.surface"],
        "speed_m_s": ["knock.speed_m_s"],
        "force_n": ["grasp.force_n"],
    }

    def __init__(self, /, **tables: Any) -> None:
        super().__init__(**tables)

    def complete(self) -> Self:
        """Copy with the values of the named surface in place of those that keep them."""
        return self.model_copy(update={"surface": self.surface.complete(self.object.surface)})

    @property
    def fingers(self) -> tuple[str, ...]:
        """Names of the fingers that touch, the thumb first."""
        return ("thumb", "index", "middle", "ring", "little")[
            : {"pinch": 2, "tri": 3, "power": 5}[self.grasp.kind]
        ]

    def find_rule_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule between parameters, with the names of the parameters it reads."""
        yield from super().find_rule_issues()
        grasp = self.grasp
        knock = self.knock
        yield from find_surface_issues(
            "object.surface",
            name=self.object.surface,
            table=self.surface,
            path_field="object.length_m",
            path_m=self.object.length_m,
        )

        if grasp.min_margin > grasp.max_margin:
            message = (
                f"{grasp.min_margin:g} is above grasp.max_margin; at most {grasp.max_margin:.12g}."
            )
            yield Issue("grasp.min_margin", message), {"grasp.min_margin", "grasp.max_margin"}

        if knock.attached and grasp.min_force_n > grasp.max_force_n:
            message = (
                f"{grasp.min_force_n:g} N is above grasp.max_force_n; at most "
                f"{grasp.max_force_n:.12g} N."
            )
            yield (
                Issue("grasp.min_force_n", message),
                {"grasp.min_force_n", "grasp.max_force_n", "knock.attached"},
            )

        if 0.0 < knock.speed_m_s < _MIN_SPEED_M_S:
            message = (
                f"{knock.speed_m_s:g} m/s takes the pin too long; at least "
                f"{_MIN_SPEED_M_S:g} m/s, or 0."
            )
            yield Issue("knock.speed_m_s", message), {"knock.speed_m_s"}

        minimum = knock.speed_m_s**2 / (1 if knock.attached else 2) / ACCELERATION_M_S2
        # The least that the message names passes, whatever its rounding.
        if knock.stroke_m < minimum * (1 - 1e-9):
            verb = "reach" if knock.attached else "stop from"
            what = f"{knock.stroke_m:g} m is too short to {verb} {knock.speed_m_s:g} m/s"
            message = f"{what}; at least {round_up(minimum):g} m."
            yield (
                Issue("knock.stroke_m", message),
                {"knock.stroke_m", "knock.speed_m_s", "knock.attached"},
            )

        stiffness = self.object.stiffness_n_per_m
        if 0.0 < stiffness < MIN_STIFFNESS_N_PER_M:
            message = (
                f"{stiffness:g} N/m is no object that a hand can hold; at least "
                f"{MIN_STIFFNESS_N_PER_M:g} N/m."
            )
            yield Issue("object.stiffness_n_per_m", message), {"object.stiffness_n_per_m"}

        yield from self.converter.find_issues()
