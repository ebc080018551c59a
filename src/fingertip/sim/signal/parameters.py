"""Schema of scene and manipulation files: strict tables, all issues reported at once, and a table
of parameters.

Both kinds have the tables of the path from force to samples, and record outputs from one list.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.board.components.values import BOARD_REMEDY
from fingertip.catalogues.file_kinds import MANIPULATION, SCENE, FileKind
from fingertip.design import Design
from fingertip.design.design_file import format_parameter_table, format_value, load_tables
from fingertip.design.parameters import Above, ParameterTable, choice, quantity
from fingertip.design.parameters.declaration import issues_from_pydantic, suggest_name
from fingertip.foundation.errors import FingertipError, Issue, TraceError, raise_issues

ACCELERATION_M_S2 = 1.0
"""Acceleration of a move [m/s2].
Assumption: 4 cm at 4 cm/s take the article about one second, here 1.04 s.
"""


@dataclass(frozen=True)
class Output:
    """Signal that a simulation can record."""

    label: str
    kinds: Collection[FileKind] = (SCENE, MANIPULATION)
    factor: float = 1.0
    """Factor from its unit to the label's."""


OUTPUTS = {
    "voltage_v": Output("sampled\nvoltage [V]"),
    "force_n": Output("normal\nforce [N]"),
    "slip": Output("true slip"),
    "velocity_m_s": Output("velocity\n[mm/s]", factor=1000),
    "shear_m": Output("pad shear\n[mm]", (SCENE,), 1000),
    "tactile_v": Output("tactile\nvoltage [V]", (SCENE,)),
    "filtered_v": Output("filtered\nvoltage [V]", (SCENE,)),
    "closing_m": Output("finger\nclosing [mm]", (MANIPULATION,), 1000),
    "command_m": Output("commanded\nclosing [mm]", (MANIPULATION,), 1000),
    "object_m": Output("object\nposition [mm]", (MANIPULATION,), 1000),
    "pin_n": Output("pin force\n[N]", (MANIPULATION,)),
    "envelope_v": Output("envelope\nvoltage [V]"),
    "sampled_envelope_v": Output("sampled\nenvelope [V]"),
    "sampled_filtered_v": Output("sampled filtered\nvoltage [V]"),
    "slip_pin_v": Output("ON/OFF\noutput [V]"),
}
"""Signals that a scene can record, and a manipulation of each finger.

voltage_v: voltage as sampled by the ADC. force_n: true normal force. slip: true gross slip;
bristles that bend while the contact sticks do not count. velocity_m_s: velocity of the pad over the
surface, including that bending (a manipulation records the opposite, that of the object over the
pad). shear_m: shear of the pad. tactile_v: voltage ahead of the filter board, with white noise that
stands for that of its amplifiers up to 1 MHz; the ADC samples the same voltage without it, because
`detector.noise_v` is all noise of a sample. filtered_v, envelope_v: outputs of the filter board,
above its output offset; without an envelope on the board (variant precision) that of filtered_v,
with the design's pole. sampled_envelope_v, sampled_filtered_v: envelope_v and filtered_v as sampled
by the ADC, above signal ground; the latter on boards for a controller, whose samples give the
former if the board has no envelope. slip_pin_v: voltage of the comparator's output, low while it
reports slip. Of a manipulation also closing_m, closing; command_m, commanded closing; and of the
object object_m, its position; pin_n, force of the pin.
"""

FILTER_OUTPUTS = frozenset(
    {"filtered_v", "envelope_v", "slip_pin_v", "sampled_envelope_v", "sampled_filtered_v"}
)
"""Outputs that need the filter board."""


class SimulationFile(BaseModel):
    """Frozen file of tables that refuses unknown names, values out of bounds and broken rules.

    Raises TraceError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)
    file_kind: ClassVar[FileKind]
    options: ClassVar[Mapping[str, Sequence[str]]]
    """Parameters that the options surface, speed_m_s and force_n of a simulation set."""

    scene: str = Field(
        "scene", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the scene."
    )
    outputs: list[str] = Field(
        ["voltage_v", "force_n", "slip"], description="Columns to record beside the time."
    )

    def __init__(self, /, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            issues = issues_from_pydantic(error, type(self))
            raise TraceError([*issues, *self._rule_issues_beside(tables, issues)]) from None

        raise_issues(TraceError, (issue for issue, _ in self.find_rule_issues()))

    def find_rule_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule between parameters, with the names of the parameters it reads."""
        known = self.known_outputs()
        if not self.outputs:
            yield (
                Issue("outputs", f"is empty; name at least one of {', '.join(known)}."),
                {"outputs"},
            )

        for name in dict.fromkeys(self.outputs):
            if name not in known:
                yield (
                    Issue("outputs", f"{name!r} is not an output; {suggest_name(name, known)}"),
                    {"outputs"},
                )
            elif self.outputs.count(name) > 1:
                times = self.outputs.count(name)
                yield (
                    Issue("outputs", f"{name!r} is named {times} times; name it once."),
                    {"outputs"},
                )

    def find_design_issues(self, design: Design, seed: int) -> Iterator[Issue]:
        """Yield the reasons why this cannot be simulated with a design and a seed."""
        if seed < 0:
            yield Issue("--seed", f"{seed} is negative; choose a whole number of at least 0.")

        if not design.board.has_filter:
            for name in (name for name in self.outputs if name in FILTER_OUTPUTS):
                yield Issue(
                    "outputs",
                    f"{name!r} is an output of a board, and a divider has none; {BOARD_REMEDY}.",
                )

            return

        if "slip_pin_v" in self.outputs and design.board.variant != "comparator":
            yield Issue("outputs", describe_missing_comparator(design.board.variant))

        if "sampled_filtered_v" in self.outputs and not design.board.is_for_controller:
            message = (
                "'sampled_filtered_v' exists on boards for a controller, and this design's "
                "board.variant is "
                f"{design.board.variant}; use --set board.variant=precision --set "
                "board.supply_v=3.3."
            )
            yield Issue("outputs", message)

    @classmethod
    def known_outputs(cls) -> tuple[str, ...]:
        """Names that `outputs` may contain."""
        return tuple(name for name, output in OUTPUTS.items() if cls.file_kind in output.kinds)

    @property
    def name(self) -> str:
        """Name of the scene, which the file calls ``scene``."""
        return self.scene

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Self:
        """Read files or bundled ones, later ones win, then changes such as ``"tap.force_n=5"``.

        Raises TraceError.
        """
        try:
            tables = load_tables(files, changes, cls.file_kind).tables
        except FingertipError as error:
            raise TraceError(error.issues) from None

        return cls(**tables)

    def list_parameters(self) -> Iterator[SceneParameter]:
        """Yield every parameter, in the order of the file."""
        schema = type(self).model_json_schema()
        outputs = self.known_outputs()

        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, ParameterTable):
                table = schema["$defs"][type(value).__name__]["properties"]
                for key, field in table.items():
                    yield _describe(f"{name}.{key}", getattr(value, key), field, outputs)
            else:
                yield _describe(name, value, schema["properties"][name], outputs)

    def format_parameters(self) -> list[str]:
        """Return the parameters as lines of a table with a header."""
        rows = [
            tuple(map(format_value, (p.name, p.value, p.unit, p.bounds, p.description)))
            for p in self.list_parameters()
        ]
        return format_parameter_table(rows).splitlines()

    @classmethod
    def _rule_issues_beside(cls, tables: Mapping[str, Any], issues: Iterable[Issue]) -> list[Issue]:
        """Broken rules among the parameters that are in bounds, so that one run reports everything
        that is wrong.
        """
        faulty = {issue.field for issue in issues}
        fields: dict[str, Any] = {}

        for name, info in cls.model_fields.items():
            value = tables.get(name)
            default = info.default
            if isinstance(default, ParameterTable):
                known = type(default).model_fields
                table = value if isinstance(value, Mapping) else {}
                valid = {
                    k: v for k, v in table.items() if k in known and f"{name}.{k}" not in faulty
                }
                fields[name] = default.model_copy(update=valid)
            else:
                fields[name] = (
                    default if value is None or any(f.startswith(name) for f in faulty) else value
                )

        return [
            issue
            for issue, reads in cls.model_construct(**fields).find_rule_issues()
            if not reads & faulty
        ]


def describe_missing_comparator(variant: str) -> str:
    """Error message for a board without comparator."""
    return (
        "'slip_pin_v' exists on boards of variant comparator only, and this design's variant is "
        f"{variant}; use --set board.variant=comparator."
    )


@dataclass(frozen=True)
class SceneParameter:
    """Parameter of a scene with its value, as `--parameters` lists it."""

    name: str
    value: object
    default: object
    unit: str
    bounds: str
    description: str


def _describe(
    name: str, value: object, field: Mapping[str, Any], outputs: Sequence[str]
) -> SceneParameter:
    low = f">= {field['minimum']:g}" if "minimum" in field else ""
    low = f"> {field['exclusiveMinimum']:g}" if "exclusiveMinimum" in field else low
    high = f"<= {field['maximum']:g}" if "maximum" in field else ""
    bounds = (
        " | ".join(field["enum"])
        if "enum" in field
        else ", ".join(part for part in (low, high) if part)
    )
    if name == "outputs":
        bounds = " | ".join(outputs)

    unit = field.get("unit", "")
    description = field.get("description", "")
    return SceneParameter(
        name=name,
        value=value,
        default=field.get("default"),
        unit=unit,
        bounds=bounds,
        description=description,
    )


# Tables that describe the path from force to samples, of scenes and manipulations alike.

MIN_BITS = 8
MIN_RANGE_V = 0.01


def assumption(
    default: float, unit: str, bounds: tuple[float | Above, float], description: str
) -> Any:
    """Declare a number with a unit that no source gives; its description says so."""
    return quantity(default, unit, bounds, f"{description} Assumption.")


class Drift(ParameterTable):
    """Slow changes of sensor and amplifier."""

    share_per_decade: float = quantity(
        0.0, "", (0, 0.2), "Creep: relative increase per decade of time (data sheet: below 0.05)."
    )
    volt_per_s: float = assumption(
        0.0, "V/s", (-0.1, 0.1), "Drift of the amplifier with temperature."
    )


class Cable(ParameterTable):
    """Touch of the cable; 0 V means none."""

    step_v: float = quantity(
        0.0, "V", (-1, 1), "Jump when the touch begins, and back when it ends."
    )
    decay_s: float = assumption(0.05, "s", (0.001, 10), "Decay time of the jump.")
    hum_v: float = quantity(0.0, "V", (0, 1), "Amplitude of the mains hum during the touch.")
    hum_hz: float = quantity(50.0, "Hz", (16, 60), "Mains frequency.")
    at_s: float = assumption(1.0, "s", (0, 600), "Start, after the holding force is reached.")
    duration_s: float = assumption(0.5, "s", (0.01, 600), "Duration.")


class Noise(ParameterTable):
    """Noise that is not white, added to the tactile voltage for
    the whole recording; 0 V means none.
    """

    pink_v: float = quantity(
        0.0,
        "V",
        (0, 0.1),
        "RMS pink noise per decade of frequency, of sensor and amplifier; 1e-4 is a noisy film. "
        "(unverified)",
    )
    hand_v: float = quantity(
        0.0,
        "V",
        (0, 0.1),
        "RMS vibration of a hand from 30 to 90 Hz while it touches; 1e-4 to 5e-4 in hands. "
        "(unverified)",
    )
    hum_v: float = quantity(0.0, "V", (0, 1), "Amplitude of the mains hum's fundamental.")
    hum_hz: float = quantity(50.0, "Hz", (16, 60), "Mains frequency.")
    hum_third: float = quantity(
        0.3,
        "",
        (0, 1),
        "Amplitude of the third harmonic, relative to the fundamental. (unverified)",
    )
    hum_fifth: float = quantity(
        0.15,
        "",
        (0, 1),
        "Amplitude of the fifth harmonic, relative to the fundamental. (unverified)",
    )


class Sensing(ParameterTable):
    """Conversion of force to voltage."""

    bridge: Literal["board", "article"] = choice(
        "board",
        "The design's bridge and amplifier; or, for comparison, a curve through the article's "
        "voltages.",
    )
    amplifiers: Literal["real", "ideal"] = choice(
        "real",
        "Amplifiers of the filter: the design's with their bandwidth, slew rate and rails, or "
        "ideal ones.",
    )
    diode: Literal["1N4148", "BAT54", "1N34A"] = choice(
        "1N4148",
        "Diode of variant article: the board's, a Schottky or a germanium diode; the article "
        "names none.",
    )
    noise: bool = Field(
        True, description="Whether the board's amplifiers and the ADC add white noise."
    )
    jitter_s: float = quantity(
        0.0,
        "s",
        (0, 1e-4),
        "RMS sampling jitter of the ADC; 0: none (assumption: a data acquisition card's).",
    )


class ConverterInput(ParameterTable):
    """Converter that samples in place of the design's ADC; 0 bits mean the design's."""

    bits: int = Field(
        0,
        ge=0,
        le=24,
        description="Resolution: 10 or 12 in most microcontrollers; 0: the design's ADC.",
    )
    low_v: float = quantity(0.0, "V", (-100, 100 - MIN_RANGE_V), "Lower end of its range.")
    high_v: float = quantity(
        5.0,
        "V",
        (-100 + MIN_RANGE_V, 100),
        "Upper end of its range: 3.3 or 5 in most microcontrollers.",
    )

    def find_issues(self) -> Iterator[tuple[Issue, set[str]]]:
        """Yield each broken rule, with the names of the parameters it reads."""
        fields = {"converter.bits", "converter.low_v", "converter.high_v"}
        min_v = round(self.low_v + MIN_RANGE_V, 6)

        if self.bits and self.high_v < min_v:
            message = (
                f"{self.high_v:g} V leaves no range above converter.low_v; at least {min_v:.9g} V."
            )
            yield Issue("converter.high_v", message), fields

        if 0 < self.bits < MIN_BITS:
            yield (
                Issue(
                    "converter.bits", f"{self.bits} is too small; choose {MIN_BITS} to 24, or 0."
                ),
                fields,
            )

        if not self.bits and self != ConverterInput():
            problem = "0 leaves the design's ADC in place, so the range has no effect"
            yield Issue("converter.bits", f"{problem}; choose 12, or leave the range out."), fields

    def find_warnings(self, min_v: float, max_v: float) -> Iterator[str]:
        """Yield a warning if the converter clips a voltage that lies between two limits [V]."""
        if self.low_v <= min_v and max_v <= self.high_v:
            return

        cut = "all of it" if max_v <= self.low_v or min_v >= self.high_v else "what lies outside"
        yield (
            f"the tactile voltage lies between {min_v:.2f} V (20 N) and {max_v:.2f} V (no force), "
            "and a converter from "
            f"{self.low_v:g} to {self.high_v:g} V clips {cut}: divide the voltage ahead of the "
            "converter, which "
            "divides slip too, or choose a range up to "
            f"converter.high_v={math.ceil(10 * max_v) / 10:g}."
        )


class PathTables(BaseModel):
    """Tables of the path from force to samples.

    A file lists them after its own, so it names this base class first.
    """

    drift: Drift = Drift()
    cable: Cable = Cable()
    noise: Noise = Noise()
    sensing: Sensing = Sensing()
    converter: ConverterInput = ConverterInput()
