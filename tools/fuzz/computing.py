"""Cases that compute: designs and scenes that are accepted, and what every command makes of them.

A case follows from seed and number alone. Its parameters are drawn from their declarations: near
the default, anywhere within the bounds, at them, and next to them. What is refused is changed as
the remedies say, as a user would type them in. A refusal that its remedies do not resolve is a case
by itself, which fails.
"""

from __future__ import annotations

import json
import math
import random
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TypeVar

import tomlkit
from pydantic.fields import FieldInfo

from fingertip.catalogues.electronics import NAMES, load_controllers
from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, PRESETS, SCENE, list_bundled_files
from fingertip.design import Design
from fingertip.design.design_file import to_toml
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds, list_choices
from fingertip.fitting.fitting import fit_design
from fingertip.foundation.errors import FingertipError, TraceError, raise_issues
from fingertip.models.parts import parts_by_name
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.signal.parameters import FILTER_OUTPUTS
from fingertip.sim.simulation import Simulation, load_simulation
from fingertip.sweep.outputs import load_outputs
from tools.fuzz.cases import Case
from tools.fuzz.remedies import FIT, as_changes, read_remedy
from tools.fuzz.values import list_parameters, write_text

LIMIT_S = 120.0
"""Limit of the processor time of a command that computes [s].
The table of a mushroom on a wide finger takes 43 s.
"""
ROUNDS = 4
"""Refusals in a row whose remedies are typed in: of bounds first,
and of rules that need values within them.
"""
LONG_S = 0.3
"""Longest of the phases that are drawn for scenes [s]."""
DETECTORS = ("digital", "analog", "fft", "fast")
_MAY_BE_REFUSED = frozenset({"new", "sweep", "manipulation", "hand"})
"""Families whose input is not known to be valid: a hand may turn out
too weak for an object, or a controller for it.
"""
_MAY_FAIL = frozenset({"build", "check", "validate", "sweep", "make"})
"""Commands that may end with exit code 1: a check fails on a coarse
mesh, or a requirement with few trials.
"""

_TASKS: tuple[tuple[str, float, tuple[str, ...]], ...] = (
    ("values", 6, ("params {design} --toml", "params {design} --json")),
    ("board", 16, ("board {design} --out b --json", "board {design} --out b --check")),
    ("board, analysed", 2, ("board {design} --out b --analysis --bode b.csv --json",)),
    ("bring-up", 0.3, ("board {design} --out b --bringup",)),
    ("firmware", 10, ("firmware {design} --out f",)),
    ("hand", 6, ("firmware {design} --out f --fingers {fingers} --controller {controller}",)),
    ("robot", 2, ("robot {design} --out r", "robot {design} --out r --format urdf --json")),
    ("sheet", 8, ("sheet {design} --out s.md --material {silicone}",)),
    ("acceptance", 0.5, ("acceptance {design} --out a.md",)),
    (
        "part",
        12,
        (
            "build {design} --out p --parts {part} --formats {meshes} --tolerance-mm {tolerance} "
            "--json",
        ),
    ),
    (
        "parts",
        5,
        (
            "build {design} --out p --formats {meshes} --tolerance-mm {tolerance} --material "
            "{silicone}",
        ),
    ),
    (
        "page",
        3,
        (
            "build {design} --out p --formats stl --tolerance-mm {tolerance}",
            "page {design} --out p",
        ),
    ),
    (
        "STEP",
        0.3,
        ("build {design} --out p --parts {part} --formats step --tolerance-mm {tolerance}",),
    ),
    ("check", 4, ("check {design} --tolerance-mm {tolerance} --json",)),
    ("drawing", 0.3, ("drawing {design} --out d",)),
    ("picture", 0.6, ("picture {design} --out e.png --width-px 400",)),
    (
        "new",
        2,
        (
            "new mine --preset {preset} --out n.toml {fitted}",
            "check n.toml --tolerance-mm {tolerance}",
        ),
    ),
    ("trial", 12, ("simulate {design} --out {trace} --seed {seed} --json", "{detect}", "{detect}")),
    (
        "trial, plotted",
        1,
        ("simulate {design} --out {trace} --plot t.png", "{detect} --plot e.png"),
    ),
    ("scene", 12, ("simulate {scene} --out {trace} --seed {seed} --json", "{detect}", "{detect}")),
    (
        "manipulation",
        1.5,
        ("simulate {manipulation} --out {trace} --seed {seed} --json", "{detect}", "{detect}"),
    ),
    ("sweep", 2, ("sweep {sweep} --out w --jobs 1 --csv w.csv", "sweep --show --out w")),
    (
        "campaign",
        0.1,
        ("validate {design} --detector {detector} --trials 2 --minutes 0.5 --out v --json",),
    ),
    ("everything", 0.2, ("make {design} --formats stl --out p",)),
)
"""Family, number in a hundred cases or so, and commands. What takes longest is rarest."""

Loaded = TypeVar("Loaded")


def draw_value(rng: random.Random, info: FieldInfo, longest: float = math.inf) -> str | None:
    """Draw the value of a parameter as TOML; None if it is a text or a list."""
    choices = list_choices(info)
    if choices:
        return write_text(rng.choice(choices))
    if info.annotation is bool:
        return rng.choice(("true", "false"))
    if info.annotation not in (int, float):
        return None

    bounds = find_bounds(info)
    default = float(info.default)
    least = bounds.minimum if bounds.above is None else bounds.above
    high = min(bounds.maximum or longest, longest)
    low = -high if least is None else least
    positive = max(low, 1e-6 * high)
    kind = rng.random()

    if kind < 0.4:
        value = float(f"{default * 2.0 ** rng.uniform(-1.0, 1.0):.5g}")
    elif kind < 0.6:
        value = float(f"{rng.uniform(low, high):.5g}")
    elif kind < 0.8:
        value = float(f"{positive * (high / positive) ** rng.random():.5g}")
    else:
        step = 1.0 if info.annotation is int else 0.0
        beside = math.nextafter
        value = rng.choice(
            (low, high, low + step, high - step, beside(low, -math.inf), beside(high, math.inf))
        )
        value = beside(low, high) if value == bounds.above and step == 0.0 else value

    return str(round(value)) if info.annotation is int else repr(value)


def draw_changes(
    rng: random.Random, parameters: Mapping[str, FieldInfo], longest: float = math.inf
) -> list[str]:
    """Draw changes of some parameters; choices, which change more, are drawn more often."""
    names = sorted(parameters)
    choices = [name for name in names if list_choices(parameters[name])]
    drawn = rng.sample(choices, rng.choice((0, 0, 1, 2))) + rng.sample(
        names, rng.choice((0, 1, 2, 4, 8))
    )
    values = {
        name: draw_value(rng, parameters[name], longest if _is_time(name) else math.inf)
        for name in drawn
    }

    return [f"{name}={value}" for name, value in values.items() if value is not None]


def _is_time(name: str) -> bool:
    return name.endswith("_s") and not name.endswith(("per_s", "m_s"))


def settle(
    load: Callable[[list[str]], Loaded], changes: Iterable[str], rounds: int = ROUNDS
) -> tuple[Loaded | None, list[str]]:
    """Load with changes, and type in the remedies of what is refused; None if that does not help.

    Returns what was loaded, and all changes, among them the option --fit.
    """
    typed = list(changes)
    for _ in range(rounds):
        try:
            return load(typed), typed
        except FingertipError as error:
            typed += [
                *as_changes(error.issues),
                *(FIT for issue in error.issues if FIT in read_remedy(issue)),
            ]

    return None, typed


def _set(changes: Iterable[str]) -> list[str]:
    return [word for change in changes for word in ("--set", change)]


class _Drawing:
    """One case as it is drawn: the words of each place in its
    commands, and the files that they name.
    """

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.files: dict[str, bytes] = {}
        self.base = rng.choice(sorted(list_bundled_files(DESIGN)))
        changes = draw_changes(rng, PARAMETERS)
        design, changes = settle(self._load, changes)

        if design is None and self._lacks_file(changes):
            design = Design.load(self.base)
            changes = []

        self.is_refused = design is None
        self.design = design or Design.load(self.base)
        self.words = [self.base, *_set(changes)]
        if design and (rng.random() < 0.5 or FIT in changes):
            self.words = [self._write_design()]

        self.trace = rng.choice(("t.csv", "t.npz"))
        self.has_converter = False
        """True if a scene has a converter of its own, whose range is
        not that of the design that a detector gets.
        """

    def _load(self, typed: list[str]) -> Design:
        changes = [change for change in typed if change != FIT]
        if FIT in typed:
            return fit_design(Design.load(self.base), changes)

        return Design.load(self.base, changes=changes)

    def _lacks_file(self, changes: list[str]) -> bool:
        """Tell whether an adapter needs a file, which no value mends."""
        try:
            self._load(changes)
        except FingertipError as error:
            return any(issue.field == "bone.adapter_file" for issue in error.issues)

        return False

    def _write_design(self) -> str:
        self.files["a.toml"] = to_toml(self.design).encode()
        return "a.toml"

    def fill(self, place: str) -> list[str]:
        """Draw the words of a place."""
        rng = self.rng
        places: Mapping[str, Callable[[], list[str]]] = {
            "design": lambda: self.words,
            "detect": lambda: [
                "detect",
                self.trace,
                "--design",
                self._write_design(),
                "--json",
                "--detector",
                self._draw_detector(),
            ],
            "controller": lambda: [rng.choice(load_controllers()).key],
            "detector": lambda: [self._draw_detector()],
            "figure": lambda: [rng.choice(("b.png", "b.svg"))],
            "fingers": lambda: [str(rng.randint(1, len(NAMES)))],
            "fitted": lambda: _set(draw_changes(rng, PARAMETERS)),
            "manipulation": lambda: self._draw_scene("manipulation", ManipulationFile),
            "meshes": lambda: [rng.choice(("stl", "3mf", "stl,3mf"))],
            "part": lambda: [rng.choice(list(parts_by_name(self.design)))],
            "preset": lambda: [rng.choice(PRESETS)],
            "scene": lambda: self._draw_scene("scene", SceneFile),
            "seed": lambda: [str(rng.choice((0, rng.randrange(2**31))))],
            "silicone": lambda: [rng.choice(list_choices(PARAMETERS["silicone.product"]))],
            "sweep": self._draw_sweep,
            "tolerance": lambda: [
                f"{rng.choice((0.05, 0.1, 0.5, 1.0)) * rng.uniform(0.5, 1.0):.3g}"
            ],
            "trace": lambda: [self.trace],
        }
        return places[place]()

    def _draw_detector(self) -> str:
        return self.rng.choice(DETECTORS if self.design.board.has_filter else ("fast",))

    def _draw_scene(self, kind: str, model: type[SceneFile | ManipulationFile]) -> list[str]:
        """Draw a scene and its design: changes of a bundled one, or a file with all of them."""
        rng = self.rng
        design = self._write_design()
        names = {"scene": SCENE, "manipulation": MANIPULATION}[kind]
        short = SHORT_PHASES[names]
        name = rng.choice(sorted(list_bundled_files(names)))
        board = self.design.board
        lacking = {
            "slip_pin_v": board.variant != "comparator",
            "sampled_filtered_v": not board.is_for_controller,
        }
        lacking |= dict.fromkeys(FILTER_OUTPUTS, True) if not board.has_filter else {}
        outputs = [
            name for name in model.known_outputs() if not lacking.get(name) and rng.random() < 0.4
        ]
        outputs = ["voltage_v", *(name for name in outputs if name != "voltage_v")]
        changes = [
            *short,
            f"outputs={json.dumps(outputs)}",
            *draw_changes(rng, list_parameters(model), LONG_S),
        ]

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / design
            path.write_bytes(self.files[design])

            def load(typed: list[str]) -> Simulation:
                simulation = load_simulation(
                    name, path, changes=[each for each in typed if each != FIT]
                )
                raise_issues(TraceError, simulation.scene.find_design_issues(simulation.design, 0))
                return simulation

            simulation, changes = settle(load, changes)

        self.is_refused = self.is_refused or simulation is None
        self.has_converter = bool(simulation and simulation.scene.converter.bits)
        if simulation and rng.random() < 0.5:
            self.files["s.toml"] = tomlkit.dumps(simulation.scene.model_dump(mode="json")).encode()
            return ["s.toml", "--design", design]

        return [name, "--design", design, *_set(changes)]

    def _draw_sweep(self) -> list[str]:
        """Draw a sweep over two values of a parameter."""
        rng = self.rng
        name = rng.choice(
            [name for name, info in sorted(PARAMETERS.items()) if info.annotation in (int, float)]
        )
        values = sorted({draw_value(rng, PARAMETERS[name]) for _ in range(2)}, key=str)
        outputs = rng.sample(sorted(load_outputs()), rng.randint(1, 3))
        lines = [
            f'design = "{self._write_design()}"',
            f"outputs = {json.dumps(outputs)}",
            "tolerance_mm = 0.2",
        ]
        self.files["w.toml"] = "\n".join(
            [*lines, "[axes]", f"{name} = [{', '.join(map(str, values))}]"]
        ).encode()

        return ["w.toml"]


SHORT_PHASES = {
    SCENE: (
        "hold.wait_s=0.05",
        "load_change.at_s=0.05",
        "tap.at_s=0.05",
        "tap.interval_s=0.05",
        "tap.count=3",
        "motor.at_s=0.02",
        "cable.at_s=0.02",
        "motor.duration_s=0.2",
        "cable.duration_s=0.2",
    ),
    MANIPULATION: (
        "grasp.settle_s=0.05",
        "grasp.let_go_s=0.05",
        "grasp.after_s=0.1",
        "grasp.close_s=0.2",
        "knock.at_s=0.05",
        "cable.at_s=0.02",
        "cable.duration_s=0.2",
    ),
}
"""Kind of bundled scenes -> changes that make them short."""


def draw_case(seed: int, number: int) -> Case:
    """Draw the case of a number."""
    rng = random.Random(f"{seed} {number}")
    family, _, commands = rng.choices(_TASKS, [weight for _, weight, _ in _TASKS])[0]
    drawing = _Drawing(rng)
    first, *then = (
        tuple(
            word
            for part in line.split()
            for word in (drawing.fill(part[1:-1]) if part[0] == "{" else [part])
        )
        for line in commands
    )
    if drawing.is_refused:
        return Case("remedy", first, drawing.files, is_accepted=True, limit_s=LIMIT_S)

    then = [words for words in then if words[0] != "detect" or not drawing.has_converter]
    lacks = set[str]() if drawing.design.board.has_filter else {"bring-up", "board, analysed"}
    return Case(
        family=family,
        words=first,
        files=drawing.files,
        promise="files",
        may_fail=not _MAY_FAIL.isdisjoint(line.split()[0] for line in commands),
        then=tuple(then),
        is_accepted=family not in _MAY_BE_REFUSED | lacks,
        limit_s=LIMIT_S,
    )
