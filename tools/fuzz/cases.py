"""Cases: commands with their words, the files that they are given, and what their success
promises.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from hypothesis import strategies as st

from fingertip.catalogues.electronics import load_controllers
from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, SWEEP
from fingertip.design import Design
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sweep.sweep_file import SweepFile
from tools.fuzz import originals
from tools.fuzz.damage import damaged, nudged
from tools.fuzz.values import (
    ODD_NUMBERS,
    ODD_TEXTS,
    Raw,
    list_parameters,
    odd_values,
    parameter_lines,
    toml_files,
    values_of,
)

_FITTED_S = 120.0
PARSED_S = 10.0
"""Limit of the processor time of a case that computes next to nothing [s]."""


@dataclass(frozen=True)
class Case:
    """A run of the program, or some in one folder."""

    family: str
    """Kind of the case in the report."""
    words: tuple[str, ...]
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Files in the working folder by relative path."""
    promise: str = ""
    """Promise of exit code 0: "design", "detection", "files" or nothing."""
    may_fail: bool = False
    """True if exit code 1 is documented for the command: it checks something."""
    then: tuple[tuple[str, ...], ...] = ()
    """Words of further commands, in the same folder."""
    is_accepted: bool = False
    """True if the input is known to be valid, so that no command may refuse it."""
    limit_s: float = PARSED_S
    """Limit of the processor time of each command, which does not
    depend on what else the machine does [s].
    """


def _no_nul(words: list[str]) -> tuple[str, ...]:
    """Words as a command line can have them: without NUL."""
    return tuple(word.replace("\0", "\ufffd") for word in words)


@st.composite
def set_cases(draw: st.DrawFn) -> Case:
    """Changes of a bundled design on the command line."""
    lines = draw(parameter_lines(Design, 4))
    words = ["params", *draw(st.sampled_from(([], ["fsr402"], ["child_thumb"]))), "--toml"]

    for name, value in lines:
        plain = draw(
            st.sampled_from(
                (
                    f"{name}={value}",
                    f"{name} = {value}",
                    f"{name}",
                    f"{name}={value.strip(chr(34))}",
                )
            )
        )
        words += ["--set", plain]

    return Case("--set", _no_nul(words), promise="design")


@st.composite
def design_cases(draw: st.DrawFn) -> Case:
    """Design files from the declarations of parameters, and damaged bundled ones."""
    if draw(st.booleans()):
        data = draw(toml_files(Design, draw(st.sampled_from((3, 8, 60)))))
        return Case("design", ("params", "a.toml", "--toml"), {"a.toml": data}, "design")

    data = draw(damaged(draw(st.sampled_from(originals.bundled(DESIGN)))))
    return Case("damaged design", ("params", "a.toml", "--toml"), {"a.toml": data}, "design")


@st.composite
def scene_cases(draw: st.DrawFn) -> Case:
    """Scenes and manipulations, from their declarations and damaged, and changes of
    bundled ones.
    """
    model, files = draw(
        st.sampled_from(
            (
                (SceneFile, originals.bundled(SCENE)),
                (ManipulationFile, originals.bundled(MANIPULATION)),
            )
        )
    )
    kind = draw(st.integers(0, 2))

    if kind == 0:
        data = draw(toml_files(model))
        return Case("scene", ("simulate", "a.toml", "--parameters"), {"a.toml": data})

    if kind == 1:
        data = draw(damaged(draw(st.sampled_from(files))))
        return Case("damaged scene", ("simulate", "a.toml", "--parameters"), {"a.toml": data})

    name = "hard_tap" if model is SceneFile else "real_manipulation"
    words = ["simulate", name, "--parameters"]
    for parameter, value in draw(parameter_lines(model, 3)):
        words += ["--set", f"{parameter}={value}"]

    return Case("scene --set", _no_nul(words))


@st.composite
def _axis(draw: st.DrawFn) -> tuple[str, Raw]:
    parameters = list_parameters(Design)
    name = draw(st.sampled_from(sorted(parameters)))
    value = values_of(parameters[name])
    if draw(st.booleans()):
        return f"axes.{name}", f"[{', '.join(draw(st.lists(value, max_size=4)))}]"

    steps = draw(
        st.sampled_from(("2", "5", "1000000000", "100000", "0", "-1", "1.5", *ODD_NUMBERS))
    )
    spacing = draw(st.sampled_from(("", "", ', spacing = "logarithmic"', ', spacing = "odd"')))
    return (
        f"axes.{name}",
        f"{{low = {draw(value)}, high = {draw(value)}, steps = {steps}{spacing}}}",
    )


@st.composite
def sweep_cases(draw: st.DrawFn) -> Case:
    """Sweep files. No point is computed: the report of a folder without a sweep is asked for."""
    words = ("sweep", "a.toml", "--show", "--out", "none")
    if draw(st.booleans()):
        return Case(
            "damaged sweep",
            words,
            {"a.toml": draw(damaged(draw(st.sampled_from(originals.bundled(SWEEP)))))},
        )

    lines = draw(parameter_lines(SweepFile, 3))
    outputs = draw(
        st.sampled_from(("[]", '["cutoff_3db_hz"]', '["delay_ms"]', '["checks_failed"]', '["odd"]'))
    )
    sampling = draw(
        st.sampled_from(
            ("", 'sampling = "sobol"\npoints = 64', 'sampling = "latin_hypercube"\npoints = 7')
        )
    )
    text = [f"outputs = {outputs}", sampling, *(f"{name} = {value}" for name, value in lines)]
    text += [f"{name} = {value}" for name, value in draw(st.lists(_axis(), max_size=3))]

    if draw(st.booleans()):
        text.append(
            f"design = {draw(st.one_of(st.just(chr(34) + 'fsr402' + chr(34)), odd_values()))}"
        )

    return Case("sweep", words, {"a.toml": "\n".join(text).encode("utf-8", "replace")})


_OPTIONS = {
    "--rate-hz": ("2000", "1000", "20000", "999", *ODD_NUMBERS),
    "--scale": ("1", "0.5", *ODD_NUMBERS),
    "--time-scale": ("ms", "1e-3", "s", *ODD_NUMBERS, *ODD_TEXTS),
    "--column": (
        "voltage_v=1",
        "voltage_v=2",
        "time_s=none",
        "time_s=1",
        "voltage_v=force_n",
        *ODD_TEXTS,
    ),
    "--calibrate": (
        "0:0.1",
        "0.05:0.15",
        "0:nan",
        "inf:-inf",
        "5:9",
        "-1:1",
        "0.1:0",
        *ODD_TEXTS,
        *ODD_NUMBERS,
    ),
    "--detector": ("digital", "fft", "fast", "analog", *ODD_TEXTS),
}


@st.composite
def detect_options(draw: st.DrawFn, most: int = 2) -> list[str]:
    """Options of `fingertip detect`."""
    words: list[str] = []
    for option in draw(st.lists(st.sampled_from(sorted(_OPTIONS)), max_size=most)):
        words += [option, draw(st.sampled_from(_OPTIONS[option]))]

    return words


@st.composite
def recording_cases(draw: st.DrawFn) -> Case:
    """Damaged recordings of each kind, and sound ones with odd options."""
    files = originals.recordings()
    # numpy's and text files are the most common ones.
    name = draw(
        st.sampled_from(
            (*files, "plain.npz", "deflated.npz", "one.npy", "two.npy", "plain.csv", "trace.tdms")
        )
    )
    sound = draw(st.integers(0, 9)) == 0
    data = files[name] if sound else draw(damaged(files[name], draw(st.sampled_from((1, 2, 6)))))
    words = ["detect", name, "--json", *draw(detect_options(3 if sound else 1))]
    family = "detect options" if sound else f"damaged {name.rpartition('.')[2]}"

    return Case(family, _no_nul(words), {name: data}, "detection")


@st.composite
def reading_cases(draw: st.DrawFn) -> Case:
    """Damaged sizes of hands; valid recordings, weighings and calipers with one other number."""
    if draw(st.integers(0, 2)) == 0:
        command = ("new", "mine", "--hand", "a.toml", "--out", "b.toml")
        file = draw(damaged(draw(st.sampled_from(originals.hands()))))
        # `new` fits a finger and checks it.
        return Case("hand", command, {"a.toml": file}, limit_s=_FITTED_S)

    words, valid = draw(
        st.sampled_from(
            (
                ("detect a.csv --json --detector fast", originals.recordings()["plain.csv"]),
                ("calibrate sensor a.csv fsr400 --out b.toml", originals.weighings()),
                (
                    "calibrate printer fsr400 --half-thickness-mm {} --plate-width-mm {}",
                    b"11.41 41.02",
                ),
            )
        )
    )
    data = draw(nudged(valid))
    return Case(
        "one number",
        tuple(words.format(*data.decode().split()).split()),
        {"a.csv": data},
        may_fail=True,
    )


_HANDS = {
    "--fingers": ("5", "thumb,index", "a,a", "6", "0", "2.5", *ODD_TEXTS, *ODD_NUMBERS),
    "--controller": (*(board.key for board in load_controllers()), *ODD_TEXTS),
    "--inputs": ("A0,A1", "A0,A1,A2,A3", "A0,A0", "PA0,PA1", "A0", ",", *ODD_TEXTS, *ODD_NUMBERS),
}


@st.composite
def firmware_cases(draw: st.DrawFn) -> Case:
    """Odd fingers, controllers and inputs of the firmware."""
    words = ["firmware", draw(st.sampled_from(("fsr400", "article"))), "--out", "f"]
    for option in draw(
        st.lists(st.sampled_from(sorted(_HANDS)), min_size=1, max_size=3, unique=True)
    ):
        words += [option, draw(st.one_of(st.sampled_from(_HANDS[option]), st.text(max_size=20)))]

    return Case("firmware options", _no_nul(words))


@st.composite
def folder_cases(draw: st.DrawFn) -> Case:
    """Damaged files in output folders: a sweep's database, a board with its manifest."""
    if draw(st.booleans()):
        data = draw(damaged(originals.sweep_database()))
        return Case(
            "database", ("sweep", "--show", "--out", "s"), {"s/sweep.sqlite": data}, may_fail=True
        )

    files = dict(originals.board_folder())
    for name in draw(st.lists(st.sampled_from(["manifest.json", *files]), min_size=1, max_size=2)):
        files[name] = draw(damaged(files[name]))

    words = draw(
        st.sampled_from(
            (("check", "b"), ("board", "fsr400", "--check", "--out", "b"), ("board", "--out", "b"))
        )
    )
    return Case("folder", words, {f"b/{name}": data for name, data in files.items()}, may_fail=True)


_WORDS = (
    ("picture", "fsr400", "--out", "p.png", "--width-px"),
    ("simulate", "--parameters", "--seed"),
    ("simulate", "--parameters", "--force-n"),
    ("simulate", "--parameters", "--speed-m-s"),
    ("params",),
    ("simulate", "--parameters", "--surface"),
    ("new",),
    ("new", "mine", "--preset"),
    ("new", "mine", "--sensor"),
    ("check", "fsr400", "--tolerance-mm"),
    ("validate", "--trials"),
    ("validate", "--minutes"),
    ("validate", "--seed"),
    ("accuracy", "--cases"),
    ("sweep",),
    ("sweep", "--show", "--out"),
    ("detect",),
    ("check",),
    ("board", "--check", "--out"),
    ("calibrate", "sensor", "fsr400"),
    ("build", "fsr400", "--formats"),
    ("params", "--set"),
    ("sheet",),
    ("page",),
    ("drawing",),
    ("make",),
)


@st.composite
def option_cases(draw: st.DrawFn) -> Case:
    """Odd values of options and arguments. Numbers that start long work are not among them."""
    words = list(draw(st.sampled_from(_WORDS)))
    odd = draw(
        st.one_of(st.sampled_from(ODD_TEXTS), st.text(max_size=30), st.sampled_from(ODD_NUMBERS))
    )
    starts_work = words[0] in (
        "picture",
        "check",
        "validate",
        "accuracy",
        "build",
        "make",
        "page",
        "drawing",
    )

    if starts_work or words == ["new"]:
        odd = draw(
            st.sampled_from(
                ("nan", "-1", "inf", "", "\x1b[31m", "9" * 5000, "x" * 5000, "\udcff", "0x10")
            )
        )

    return Case("options", _no_nul([*words, odd]), may_fail=True)


_WEIGHTS = {
    set_cases: 20,
    design_cases: 16,
    scene_cases: 12,
    sweep_cases: 12,
    recording_cases: 24,
    reading_cases: 12,
    option_cases: 3,
    firmware_cases: 3,
    folder_cases: 1,
}
"""Parts of all cases. What takes longest is rarest."""


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """Cases of all families."""
    families = [family for family, weight in _WEIGHTS.items() for _ in range(weight)]
    return draw(draw(st.sampled_from(families))())
