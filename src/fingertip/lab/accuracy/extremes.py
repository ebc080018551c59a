"""Extreme and stiff cases of every kernel, each compared with a reference.

A case is held if its deviation stays within a bound, refused if a FingertipError says why, and
wrong otherwise, as with any other exception or a result that is no number. A case depends on its
family's name and its number alone. Cases with even numbers stay inside the documented bounds, odd
ones go beyond.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.numerics import Array
from fingertip.foundation.workers import call_each
from fingertip.sim.contact.dragged_pad import Mount, NormalContact, integrate
from fingertip.sim.contact.friction import ELASTO_PLASTIC, Friction
from fingertip.sim.runs.timeline import TrapezoidalMove
from fingertip.sim.signal.analog_circuit import Amplifiers, AnalogBoard, Diode
from fingertip.sim.signal.filter_board import simulate_board

Range = tuple[float, float]


@dataclass
class Draw:
    """Values of one case."""

    family: str
    number: int
    values: dict[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.rng = random.Random(f"extremes:{self.family}:{self.number}")
        self.is_inside = self.number % 2 == 0

    def log(self, name: str, inside: Range, beyond: Range) -> float:
        """Draw a value whose logarithm is uniform."""
        low, high = inside if self.is_inside else beyond
        value = math.exp(self.rng.uniform(math.log(low), math.log(high)))
        self.values[name] = value
        return value

    def choose(self, name: str, options: Sequence[Any]) -> Any:
        value = self.rng.choice(options)
        self.values[name] = value
        return value

    def describe(self) -> str:
        """Return the names and values of what was drawn."""
        return ", ".join(
            f"{name} {value:.3g}" if isinstance(value, float) else f"{name} {value}"
            for name, value in self.values.items()
        )


CONTACT_ERROR = 100.0
BOUNCING_ERROR = 0.1
"""Bound of the error of a contact, in tolerances; where the pad leaves a surface that has a
resonance, it is also a share of the load, as every impact multiplies the errors before it.

Far beyond the bounds of parameters a pad can swing by itself, and every swing multiplies the errors
before it, until no solver knows the motion: for one such pad, scipy's Radau at relative tolerances
of 1e-8 and of 1e-10 gives motions that are 12 000 tolerances apart. There the bound holds as long
as a tenth of the tolerance gives the reference within one tolerance, and the forces bound the rest.
That takes 4 of 41 000 contacts.
"""


def _draw_contact(draw: Draw, sigma0_per_m: Range) -> tuple[Friction, Mount]:
    mu_c = draw.log("mu_c", (0.01, 2.3), (1e-6, 10.0))
    stribeck = draw.log("Stribeck velocity [m/s]", (1e-3, 1.0), (1e-6, 10.0))
    sigma0 = draw.log("sigma0 [1/m]", (25e3, 25.001e3), sigma0_per_m)
    sigma1 = draw.log("sigma1 [s/m]", (2.0, 2.0001), (1e-3, 10.0))
    sigma2 = draw.log("sigma2 [s/m]", (0.6, 0.60001), (1e-3, 10.0))
    # Friction only takes energy up to a drop of mu_s - mu_c = mu_c sigma2 / sigma1.
    share = draw.log("drop / largest passive drop", (0.01, 0.95), (1e-6, 0.999))
    drop = share * mu_c * sigma2 / sigma1
    mass = draw.log("mass [kg]", (1e-4, 2.0), (1e-6, 10.0))
    stiffness = draw.log("stiffness [N/m]", (10.0, 1e5), (1e-2, 1e6))
    zeta = draw.log("damping ratio", (0.05, 0.8), (0.02, 3.0))
    friction = Friction(
        mu_s=mu_c + drop,
        mu_c=mu_c,
        stribeck_m_s=stribeck,
        sigma0=sigma0,
        sigma1=sigma1,
        sigma2=sigma2,
    )

    return friction, Mount(mass, stiffness, 2 * zeta * math.sqrt(stiffness * mass))


def _draw_drag(draw: Draw, time_s: Array, load_n: float) -> tuple[Array, Array, Array]:
    """Draw position and velocity of the carriage, and the load, over a time."""
    span = float(time_s[-1])
    speed = draw.log("speed [m/s]", (1e-3, 0.2), (1e-4, 3.0))
    load = draw.choose("load is", ("constant", "gone at once", "half waves", "a ramp"))

    starts = ("slowly",) if draw.is_inside else ("slowly", "at once")
    if draw.choose("carriage starts", starts) == "slowly":
        move = TrapezoidalMove.with_speed(0.1 * span, 0.6 * speed * span, speed, 20 * speed / span)
        at = move.position_m(time_s)
        velocity = move.velocity_m_s(time_s)
    else:
        at = speed * time_s
        velocity = np.full_like(time_s, speed)

    share = {
        "constant": np.ones_like(time_s),
        "gone at once": np.interp(time_s / span, (0.5, 0.501), (1.0, 0.0)),
        "half waves": np.maximum(np.sin(10 * math.pi * time_s / span), 0.0),
        "a ramp": np.clip(2 * time_s / span, 0.0, 1.0),
    }[load]
    return at, velocity, load_n * share


def given_load(draw: Draw) -> float:
    """Compare a pad under a given load with a hundredth of the tolerance."""
    friction, mount = _draw_contact(draw, (1.0, 1e9))
    load_n = draw.log("load [N]", (1e-3, 70.0), (1e-4, 1e3))
    friction = replace(friction, elastic=draw.choose("elastic", (0.0, ELASTO_PLASTIC)))
    return _compare(draw, friction, mount, None, load_n)


def resonance(draw: Draw) -> float:
    """Compare a pad on a resonance with a hundredth of the tolerance."""
    friction, mount = _draw_contact(draw, (1.0, 1e8))
    load_n = draw.log("load [N]", (1e-3, 70.0), (1e-4, 1e2))
    friction = replace(friction, elastic=draw.choose("elastic", (0.0, ELASTO_PLASTIC)))
    normal = NormalContact(
        draw.log("resonance [Hz]", (20.0, 500.0), (1.0, 1e4)),
        draw.log("its damping ratio", (0.05, 0.8), (0.01, 3.0)),
    )
    return _compare(draw, friction, mount, normal, load_n)


def _compare(
    draw: Draw, friction: Friction, mount: Mount, normal: NormalContact | None, load_n: float
) -> float:
    step_s = draw.log("sample time [s]", (1e-4, 1e-3), (1e-5, 1e-2))
    columns = _draw_drag(draw, np.asarray(np.arange(101) * step_s, dtype=np.float64), load_n)
    tolerance_n = 1e-5 * max(load_n, 1e-2)
    finest = integrate(friction, mount, normal, step_s, *columns, tolerance_n / 100)

    def find_errors_n(tolerance_n: float) -> Array:
        motion = integrate(friction, mount, normal, step_s, *columns, tolerance_n)
        spring_n = mount.stiffness_n_per_m * np.abs(motion.position_m - finest.position_m)
        return np.maximum(spring_n, np.abs(motion.force_n - finest.force_n))

    errors_n = find_errors_n(tolerance_n)
    bound_n = tolerance_n * CONTACT_ERROR
    if normal and (finest.force_n == 0.0).any():
        bound_n += BOUNCING_ERROR * load_n
    if draw.is_inside or errors_n.max() <= bound_n:
        return float(errors_n.max() / bound_n)

    pull_n = mount.stiffness_n_per_m * np.abs(columns[0] - finest.position_m)
    is_known = np.minimum.accumulate(find_errors_n(tolerance_n / 10) <= tolerance_n)
    bounds_n = np.where(is_known, bound_n, load_n + pull_n.max())

    return float((errors_n / bounds_n).max())


TOLERANCE_V = 1e-4
SAMPLES = 200


def _draw_amplifiers(draw: Draw) -> Amplifiers | Literal["ideal"]:
    if draw.choose("amplifiers", ("ideal", "real")) == "ideal":
        return "ideal"

    bandwidth_hz = draw.log("bandwidth [Hz]", (1e6, 2e7), (1e4, 1e9))
    slew_v_per_s = draw.log("slew rate [V/s]", (1e6, 5e7), (1e3, 1e9))
    peak_v = draw.log("rail [V]", (1.0, 12.0), (0.1, 100.0))
    reversal_v = 0.6 * peak_v if draw.choose("jumps up", (False, True)) else None

    return Amplifiers(
        bandwidth_hz=bandwidth_hz,
        slew_v_per_s=slew_v_per_s,
        peak_v=peak_v,
        trough_v=peak_v,
        reversal_v=reversal_v,
    )


def board(draw: Draw) -> float:
    """Compare rectifier and envelope with a ten-thousandth of the tolerance of one step."""
    fitted = AnalogBoard.from_design(
        Design.load(draw.choose("board", ("article", "fsr400"))), _draw_amplifiers(draw)
    )
    values = {
        component: float(value) * draw.log("component / nominal", (0.8, 1.25), (0.1, 10.0))
        for component, value in fitted.components.items()
    }
    fitted = fitted.with_components(**values)

    if fitted.rectifier == "diode":
        saturation = draw.log("saturation current [A]", (1e-10, 1e-8), (1e-15, 1e-6))
        series = draw.log("series resistance [ohm]", (0.1, 10.0), (1e-3, 1e5))
        fitted = replace(
            fitted, diode=Diode(saturation, draw.log("emission", (1.5, 2.0), (1.0, 2.5)), series)
        )

    step = draw.log("step [s]", (6.25e-6, 1e-4), (1e-6, 1e-3))
    frequency = draw.log("frequency times step", (1e-3, 0.1), (1e-4, 0.2))
    amplitude = draw.log("amplitude [V]", (1e-4, 0.1), (1e-6, 10.0))
    cycle = 2 * math.pi * frequency * np.arange(SAMPLES)
    shape = draw.choose("input", ("burst", "step", "noise"))
    wave = np.sin(cycle) if shape == "burst" else np.ones(SAMPLES)

    if shape == "noise":
        noise = np.random.RandomState(draw.number).standard_normal(SAMPLES)
        wave = np.convolve(noise, np.hanning(12) / 6, "same")

    voltage = amplitude * wave * (np.arange(SAMPLES) > SAMPLES // 8)
    envelope_v = simulate_board(fitted, step, voltage, TOLERANCE_V).envelope_v
    exact_v = simulate_board(fitted, step, voltage, max(1e-8, 1e-6 * amplitude)).envelope_v
    bound_v = 10 * TOLERANCE_V + 0.05 * np.abs(exact_v).max()
    return float(np.abs(envelope_v - exact_v).max() / bound_v)


FAMILIES: Mapping[str, tuple[str, float, Callable[[Draw], float]]] = {
    "contact, given load": ("tolerance / 100: 100 tolerances", 0.57, given_load),
    "contact, resonance": (
        "tolerance / 100: 100 tolerances (bouncing: 10 % of the load)",
        0.25,
        resonance,
    ),
    "board": ("tolerance / 10000: 10 tolerances and 5 % of the peak", 0.1, board),
}
"""Name -> reference and bound, share of all cases by their cost, and function that computes a case.

The function returns the largest deviation in relation to the bound: up to 1 a case is held.
"""
BLOCK = 8
"""Number of cases that one process tries in a row."""
MAX_REFUSED = 0.02
"""Largest share of the cases inside the documented bounds that may be refused."""


@dataclass(frozen=True)
class Case:
    """Case that was tried, and what came of it."""

    draw: Draw
    deviation: float
    """Largest deviation in relation to the bound; NaN if the case was refused, or failed."""
    refused_by: str
    """Field that the refusal names; empty if it was not refused."""
    cpu_s: float

    @property
    def is_held(self) -> bool:
        return self.deviation <= 1.0


def try_cases(family: str, numbers: Iterable[int]) -> list[Case]:
    """Try some cases of a family, one after the other."""
    cases = []
    for number in numbers:
        draw = Draw(family, number)
        begin = time.process_time()
        deviation = math.nan
        refused_by = ""

        try:
            deviation = FAMILIES[family][2](draw)
        except FingertipError as error:
            refused_by = error.issues[0].field
        except Exception as error:
            draw.values["raised"] = repr(error)

        cases.append(Case(draw, deviation, refused_by, time.process_time() - begin))

    return cases


@dataclass(frozen=True)
class FamilyResult:
    """Cases of one family that were tried."""

    name: str
    cases: list[Case] = field(default_factory=list)

    @property
    def refused(self) -> list[Case]:
        return [case for case in self.cases if case.refused_by]

    @property
    def wrong(self) -> list[Case]:
        return [case for case in self.cases if not case.refused_by and not case.is_held]

    @property
    def refused_inside(self) -> float:
        """Refused share of the cases inside the bounds."""
        refused = sum(case.draw.is_inside for case in self.refused)
        return refused / sum(case.draw.is_inside for case in self.cases)

    @property
    def is_passed(self) -> bool:
        return not self.wrong and self.refused_inside <= MAX_REFUSED


def try_families(
    count: int, advance: Callable[[float], None] = lambda _: None
) -> list[FamilyResult]:
    """Try so many cases of all families together, at least two of each."""
    sizes = {name: max(2, round(count * weight)) for name, (_, weight, _) in FAMILIES.items()}
    blocks = []
    for name, size in sizes.items():
        for first in range(0, size, BLOCK):
            blocks.append(partial(try_cases, name, range(first, min(first + BLOCK, size))))

    results = {name: FamilyResult(name) for name in FAMILIES}
    done = 0

    for cases in call_each(blocks):
        results[cases[0].draw.family].cases.extend(cases)
        done += len(cases)
        advance(done / sum(sizes.values()))

    return [*results.values()]
