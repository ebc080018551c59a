"""Completion in bash, zsh and fish: the words that options and arguments take, and `fingertip completion`.

At the tab key the shell starts the program with the line before the cursor, and typer finds what may stand there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, get_args

from fingertip.catalogues.controllers import NAMES
from fingertip.catalogues.silicones import SiliconeName

VARIABLE = "_FINGERTIP_COMPLETE"
"""Environment variable by which a shell asks for completions."""

SHELLS = ("bash", "zsh", "fish")


def read_script(shell: str) -> str:
    """Read what a shell runs, of `completion.bash` and the others.

    The script gets lines of a word, a tab and its meaning; where there is none, it completes files. No space follows
    the name of a parameter, which ends in =.
    """
    return Path(__file__).with_suffix(f".{shell}").read_text(encoding="utf-8").rstrip("\n")


def answer_shell(root: Any) -> None:
    """Print what may stand at the cursor, for the command line of a program."""
    from typer._completion_classes import FishComplete

    shell = FishComplete(root, {}, "fingertip", VARIABLE)
    for item in shell.get_completions(*shell.get_completion_args()):
        print(item.value, *([first_sentence(item.help)] if item.help else []), sep="\t")


def first_sentence(text: str) -> str:
    first = text.split("\n\n")[0]
    end = first.find(". ")
    return first if end < 0 else first[: end + 1]


# Words that a parameter of a command takes. Functions import what they need when a shell asks.


def _words(*words: str) -> Callable[[], Iterable[str]]:
    return lambda: words


def _files(*kinds: str) -> Callable[[str], Iterable[str]]:
    """Bundled files of some kinds, and files of the user, of any kind."""

    def complete(incomplete: str) -> Iterable[str]:
        import glob

        from fingertip.catalogues import file_kinds
        from fingertip.catalogues.bundled import list_bundled_files

        bundled = list_bundled_files(*(getattr(file_kinds, kind) for kind in kinds))
        own = glob.glob(f"{glob.escape(incomplete)}*.toml")
        return [*bundled, *sorted(name for name in own if name.isprintable())]  # others would control the terminal

    return complete


def _hands() -> Iterable[str]:
    from fingertip.catalogues.bundled import PARAMS

    return sorted(path.stem for path in (PARAMS / "hands").glob("*.toml"))


def _settings() -> Iterable[str]:
    """Parameters with =, and with each choice of those that have choices."""
    from fingertip.design.parameters import PARAMETERS
    from fingertip.design.parameters.declaration import list_choices

    return [f"{path}={choice}" for path, field in PARAMETERS.items() for choice in list_choices(field) or ("",)]


COMPLETIONS = {
    "design": _files("DESIGN"),
    "designs": _files("DESIGN"),
    "simulate file": _files("DESIGN", "SCENE", "MANIPULATION"),
    "sweep file": _files("SWEEP"),
    "changes": _settings,
    "hand": _hands,
    "finger": _words(*(f"{name}=" for name in NAMES)),
    "preset": _words(*(f"{age}_{digit}" for age in ("adult", "child", "youth") for digit in ("finger", "thumb"))),
    "formats": _words("stl", "3mf", "step", "cq", "stl,3mf", "stl,3mf,step"),
    "parts": _words("bone", "skin", "mold_palmar", "mold_dorsal", "core", "stand", "pin", "hand_stub"),
    "material": _words(*get_args(SiliconeName), "own"),
    "detector": _words("digital", "analog", "fft", "fast", "incipient"),
    "grip": _words("fast", "incipient", "digital", "analog"),
    "surface": _files("SURFACE"),
    "time_scale": _words("s", "ms", "us", "ns"),
    "kind": _words("design", "set", "scene", "manipulation", "surface", "sweep"),
    "shell": _words(*SHELLS),
}
"""Parameter of all commands, or of one, -> words that it takes."""
