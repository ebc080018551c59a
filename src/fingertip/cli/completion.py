"""Completion in bash, zsh and fish: words of options and arguments.

At the tab key the shell starts the program with the line before the cursor, and typer finds what
may stand there.
"""

from __future__ import annotations

import glob
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from fingertip.catalogues.electronics import NAMES
from fingertip.foundation.errors import join_words
from fingertip.slip.detectors.registry import describe_detectors, list_detectors

VARIABLE = "_FINGERTIP_COMPLETE"
"""Environment variable by which a shell asks for completions."""

SHELLS = ("bash", "zsh", "fish")


def read_script(shell: str) -> str:
    """Read what a shell runs, of `completion.bash` and the others.

    The script gets lines of a word, a tab and its meaning; where there is none, it completes files.
    No space follows the name of a parameter, which ends in =.
    """
    return Path(__file__).with_suffix(f".{shell}").read_text(encoding="utf-8").rstrip("\n")


def answer_shell(root: Any) -> None:
    """Print what may stand at the cursor, for the command line of a program."""
    from typer._completion_classes import FishComplete

    shell = FishComplete(root, {}, "fingertip", VARIABLE)
    for item in shell.get_completions(*shell.get_completion_args()):
        print(item.value, *([first_sentence(fill_lists(item.help))] if item.help else []), sep="\t")


def first_sentence(text: str) -> str:
    first = text.split("\n\n")[0]
    end = first.find(". ")
    return first if end < 0 else first[: end + 1]


# Words that a parameter of a command takes, each list from the table that decides. Functions import
# what they need when a shell asks, or a help page is written.


def _bundled(*kinds: str) -> Iterable[str]:
    from fingertip.catalogues.file_kinds import KINDS, list_bundled_files

    return list_bundled_files(*(kind for kind in KINDS if kind.name in kinds))


def _files(*kinds: str) -> Callable[[str], Iterable[str]]:
    """Return the completion of bundled files of some kinds, and of the user's own files."""

    def complete(incomplete: str) -> Iterable[str]:
        # Names with control characters would control the terminal.
        own = glob.glob(f"{glob.escape(incomplete)}*.toml")
        return [*_bundled(*kinds), *sorted(name for name in own if name.isprintable())]

    return complete


def _table(code: str) -> Callable[[], Iterable[str]]:
    """Return the names of a table or of a function, given as "module:name", when asked."""

    def names() -> Iterable[str]:
        module, _, name = code.partition(":")
        table = getattr(import_module(f"fingertip.{module}"), name)
        return [*(table() if callable(table) else table)]

    return names


def _choices(parameter: str) -> Callable[[], Iterable[str]]:
    """Return the completion of the choices of a design's parameter."""

    def names() -> Iterable[str]:
        from fingertip.design.parameters import PARAMETERS
        from fingertip.design.parameters.declaration import list_choices

        return list_choices(PARAMETERS[parameter])

    return names


def _settings() -> Iterable[str]:
    """List the parameters with =, and each choice of those that have choices."""
    from fingertip.design.parameters import PARAMETERS
    from fingertip.design.parameters.declaration import list_choices

    settings = []
    for path, field in PARAMETERS.items():
        settings += [f"{path}={choice}" for choice in list_choices(field) or ("",)]

    return settings


def _sets_of_formats() -> Iterable[str]:
    """List the formats, and the first two, three and so on of the default ones."""
    from fingertip.cad.files.part_formats import PART_FORMATS, default_formats

    names = default_formats()
    return [*PART_FORMATS, *(",".join(names[: i + 1]) for i in range(1, len(names)))]


COMPLETIONS: Mapping[str, Callable[..., Iterable[str]]] = {
    "design": _files("design"),
    "designs": _files("design"),
    "simulate file": _files("design", "scene", "manipulation"),
    "sweep file": _files("sweep"),
    "changes": _settings,
    "sensor": _choices("sensor.model"),
    "hand": _table("design.hand_sizes:list_hands"),
    "finger": lambda: [f"{name}=" for name in NAMES],
    "preset": _table("catalogues.file_kinds:PRESETS"),
    "formats": _sets_of_formats,
    "parts": _table("models.parts:PARTS"),
    "material": _choices("silicone.product"),
    "detector": list_detectors,
    "grip": list_detectors,
    "surface": _files("surface"),
    "controller": _table("catalogues.electronics:list_keys"),
    "time_scale": _table("slip.traces.sampling:TIME_UNITS_S"),
    "shell": lambda: SHELLS,
}
"""Parameter of all commands, or of one, -> words that it takes."""

_LISTS: Mapping[str, Callable[[], Iterable[str]]] = {
    "sensors": COMPLETIONS["sensor"],
    "silicones": COMPLETIONS["material"],
    "hands": COMPLETIONS["hand"],
    "presets": COMPLETIONS["preset"],
    "fingers": lambda: [", ".join(NAMES)],
    "formats": lambda: [", ".join(_table("cad.files.part_formats:PART_FORMATS")())],
    "sweeps": lambda: _bundled("sweep"),
    "detectors": describe_detectors,
}
"""Name in braces in the text of a help page -> words that take its place."""


def fill_lists(text: str) -> str:
    """Put lists of names into a text for the help page, which says where: "Preset: {presets}"."""
    for name, find in _LISTS.items():
        if f"{{{name}}}" in text:
            text = text.replace(f"{{{name}}}", join_words(find(), "or"))

    return text
