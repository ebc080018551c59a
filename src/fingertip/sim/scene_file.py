"""A scene file: what one fingertip goes through, and which signals are wanted of it. Strict like a design file.

Every table has neutral defaults, so a file names only what happens: no distance, no slide; no force, no tap. Figures
come with their source where there is one; the others are assumptions, and say so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.design.cascade import gather
from fingertip.design.faults import from_pydantic, nearest
from fingertip.design.fields import Section, choice, quantity
from fingertip.errors import Fault, FingertipError, TraceError

OUTPUTS = (
    "voltage_v",
    "force_n",
    "slip",
    "velocity_m_s",
    "shear_m",
    "tactile_v",
    "filtered_v",
    "envelope_v",
)
"""voltage_v: sampled; force_n: true normal force; slip: true gross slip; velocity_m_s: of the pad over the surface;
shear_m: of the pad; tactile_v: ahead of converter and filter board; filtered_v, envelope_v: of the filter board."""


class Contact(Section):
    """The surface, and how the pad answers it."""

    surface: Literal["smooth", "medium", "gross", "wood", "paper", "plastic"] = choice(
        "medium", "One of the article's six (III.C)."
    )
    length_m: float = quantity(0.1, "m", "Length of the surface. Assumption.", above=0, most=1)
    resonance_hz: float = quantity(
        90.0, "Hz", "Normal resonance at 1 N: 90 embedded, 230 the bare sensor (article, fig. 2).", least=20, most=500
    )
    bristles: Literal["plain", "elasto_plastic"] = choice(
        "plain", "LuGre as published, or without its creep below breakaway."
    )
    feedback: bool = Field(False, description="Whether vibration of the load acts back on friction.")


class Hold(Section):
    """The hand: how it presses, and how hard."""

    mode: Literal["press", "grasp"] = choice("press", "Down to a depth (sliding finger), or up to a force (grasp).")
    force_least_n: float = quantity(0.2, "N", "The seed draws the force from here (article, III.C).", above=0, most=4)
    force_most_n: float = quantity(2.0, "N", "To here; the lift of 5 cm ends contacts of up to 4 N.", above=0, most=4)
    share: float = quantity(
        1.0, "", "Part of a grasp's force on this finger: thumb 1, each of two fingers against it 0.5.", above=0, most=1
    )
    close_s: float = quantity(0.4, "s", "A grasp's force rises in this time. Assumption.", least=0.02, most=10)
    wait_s: float = quantity(1.0, "s", "Between the phases (article, III.C).", least=0, most=60)
    least_s: float = quantity(0.0, "s", "Hold for this long at least.", least=0, most=600)
    release: bool = Field(True, description="Whether the finger lifts (press) or the grasp opens at the end.")
    after_s: float = quantity(0.2, "s", "Recorded at the end. Assumption.", least=0, most=60)


class Slide(Section):
    """The surface passes under the finger; 0 m: it does not."""

    distance_m: float = quantity(0.0, "m", "Way (article: 0.04).", least=0, most=1)
    speed_m_s: float = quantity(0.04, "m/s", "Peak (article: 0.04, 0.06, 0.08).", least=0.005, most=0.2)
    acceleration_m_s2: float = quantity(1.0, "m/s2", "Of the trapezoid's ends. Assumption.", least=0.05, most=20)


class LoadChange(Section):
    """The holding force changes once; 0 N: it does not."""

    by_n: float = quantity(0.0, "N", "Added to the force on this finger.", least=-4, most=4)
    rise_s: float = quantity(0.1, "s", "In this time. Assumption.", least=0.001, most=10)
    at_s: float = quantity(1.0, "s", "After the force is reached.", least=0, most=600)


class Tap(Section):
    """Something knocks on the held object; 0 N: nothing does."""

    force_n: float = quantity(0.0, "N", "Peak of the force.", least=0, most=50)
    rise_s: float = quantity(0.004, "s", "Rise, and fall, of a tap: 2 to 10 ms. Assumption.", least=0.001, most=0.1)
    at_s: float = quantity(1.0, "s", "The first, after the force is reached.", least=0, most=600)
    count: int = quantity(1, "", "How many.", least=1, most=1000)
    interval_s: float = quantity(0.5, "s", "From one to the next.", least=0.01, most=600)


class Motor(Section):
    """The hand's motors shake the finger; 0 N: they stand still."""

    force_n: float = quantity(0.0, "N", "Amplitude of the fundamental.", least=0, most=5)
    frequency_hz: float = quantity(45.0, "Hz", "Of the fundamental. Assumption.", least=1, most=500)
    harmonic: float = quantity(0.3, "", "Amplitude of the second harmonic, as a share. Assumption.", least=0, most=1)
    at_s: float = quantity(1.0, "s", "After the force is reached.", least=0, most=600)
    duration_s: float = quantity(1.0, "s", "For this long.", least=0.01, most=600)


class Drift(Section):
    """The sensor's slow changes."""

    share_per_decade: float = quantity(
        0.0, "", "Creep: force shown more per decade of time (data sheet: below 0.05).", least=0, most=0.2
    )
    volt_per_s: float = quantity(0.0, "V/s", "Of the amplifier, with temperature. Assumption.", least=-0.1, most=0.1)


class Cable(Section):
    """Somebody touches the cable; 0 V: nobody does."""

    step_v: float = quantity(0.0, "V", "Jump when the touch begins, and back when it ends.", least=-1, most=1)
    decay_s: float = quantity(0.05, "s", "The jump decays in this time. Assumption.", least=0.001, most=10)
    hum_v: float = quantity(0.0, "V", "Amplitude of the mains' hum during the touch.", least=0, most=1)
    hum_hz: float = quantity(50.0, "Hz", "Of the mains.", least=16, most=60)
    at_s: float = quantity(1.0, "s", "After the force is reached.", least=0, most=600)
    duration_s: float = quantity(0.5, "s", "For this long.", least=0.01, most=600)


class Sensing(Section):
    """From force to voltage."""

    bridge: Literal["board", "article"] = choice(
        "board", "The design's bridge and amplifier, or a curve through the article's voltages."
    )
    jitter_s: float = quantity(
        0.0,
        "s",
        "Of the converter's instants, rms; 0: none (assumption: a data acquisition card's).",
        least=0,
        most=1e-3,
    )


class SceneFile(BaseModel):
    """One scene, validated: all faults at once.

    Raises
    ------
    TraceError
        With one sentence for each parameter out of bounds, unknown name or broken rule.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip scene")

    scene: str = Field("scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the scene.")
    outputs: list[str] = Field(["voltage_v", "force_n", "slip"], description="Columns wanted beside the time.")
    contact: Contact = Contact()
    hold: Hold = Hold()
    slide: Slide = Slide()
    load_change: LoadChange = LoadChange()
    tap: Tap = Tap()
    motor: Motor = Motor()
    drift: Drift = Drift()
    cable: Cable = Cable()
    sensing: Sensing = Sensing()

    def __init__(self, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            faults = from_pydantic(error, type(self))
            raise TraceError([*faults, *_rules_beside(tables, faults)]) from None
        if faults := [fault for fault, _ in _broken(self)]:
            raise TraceError(faults)

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> SceneFile:
        """Read a scene: defaults, then each file, then changes such as ``"tap.force_n=5"``.

        Raises
        ------
        TraceError
            If a file is missing or no valid TOML, or the scene it gives is refused.
        """
        try:
            tables = gather(files, changes)
        except FingertipError as error:
            raise TraceError(error.faults) from None
        return cls(**tables)


def _rules_beside(tables: Mapping[str, Any], faults: Iterable[Fault]) -> list[Fault]:
    """Broken rules among the parameters that are in bounds, so that one run tells everything that is wrong."""
    faulty = {fault.field for fault in faults}
    fields: dict[str, Any] = {}
    for name, info in SceneFile.model_fields.items():
        given, default = tables.get(name), info.default
        if isinstance(default, Section):
            known = type(default).model_fields
            table = given if isinstance(given, Mapping) else {}
            kept = {k: v for k, v in table.items() if k in known and f"{name}.{k}" not in faulty}
            fields[name] = default.model_copy(update=kept)
        else:
            fields[name] = default if given is None or any(f.startswith(name) for f in faulty) else given
    return [fault for fault, reads in _broken(SceneFile.model_construct(**fields)) if not reads & faulty]


def _broken(s: SceneFile) -> Iterator[tuple[Fault, set[str]]]:
    """Rules between parameters that do not hold, and the parameters each reads."""
    if not s.outputs:
        yield Fault("outputs", f"is empty; name at least one of {', '.join(OUTPUTS)}."), {"outputs"}
    for name in dict.fromkeys(s.outputs):
        if name not in OUTPUTS:
            yield Fault("outputs", f"{name!r} is no output; {nearest(name, OUTPUTS)}"), {"outputs"}
        elif s.outputs.count(name) > 1:
            yield Fault("outputs", f"{name!r} is named {s.outputs.count(name)} times; name it once."), {"outputs"}
    hold, slide, tap = s.hold, s.slide, s.tap
    if hold.force_least_n > hold.force_most_n:
        sentence = f"{hold.force_least_n:g} N is above hold.force_most_n; at most {hold.force_most_n:g} N."
        yield Fault("hold.force_least_n", sentence), {"hold.force_least_n", "hold.force_most_n"}
    if slide.distance_m > s.contact.length_m:
        sentence = f"{slide.distance_m:g} m is longer than contact.length_m; at most {s.contact.length_m:g} m."
        yield Fault("slide.distance_m", sentence), {"slide.distance_m", "contact.length_m"}
    if tap.force_n and tap.count > 1 and tap.interval_s < 2 * tap.rise_s:
        sentence = f"{tap.interval_s:g} s lets taps overlap; at least {2 * tap.rise_s:g} s."
        yield Fault("tap.interval_s", sentence), {"tap.interval_s", "tap.rise_s", "tap.count"}
    least = hold.force_least_n * (hold.share if hold.mode == "grasp" else 1.0)
    if s.load_change.by_n <= -least:
        sentence = f"{s.load_change.by_n:g} N ends the contact; above {-least:g} N, or use hold.release."
        yield Fault("load_change.by_n", sentence), {"load_change.by_n", "hold.force_least_n", "hold.share"}
