"""Help pages: plain text of at most 80 columns, options in groups, flags without a type, and examples to copy.

typer draws help pages in boxes, with a type beside each flag. These classes write the text themselves, from the
attributes of the parameters that all versions of typer share.
"""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from fingertip.cli.console import COMMON

# Examples on the help pages: each is a command to copy, and a test runs it.


EXAMPLES: dict[str, tuple[str, ...]] = {
    "": (
        "fingertip make fsr400",
        "fingertip new myfinger --sensor fsr402",
        "fingertip detect out/fsr400/signal/trace.csv",
    ),
    "new": (
        "fingertip new myfinger --sensor fsr402",
        "fingertip new mytip --preset adult_finger --hand flexible_flyer",
    ),
    "params": ("fingertip params fsr402", "fingertip params fsr400 --set skin.width_mm=18 --toml"),
    "schema": ("fingertip schema design", "fingertip schema sweep"),
    "make": ("fingertip make fsr400", "fingertip make fsr400 --set skin.width_mm=18 --out out/wider"),
    "build": (
        "fingertip build fsr400 --formats stl",
        "fingertip build fsr400 --set skin.width_mm=18 --set name=wider --formats stl,3mf",
    ),
    "check": (
        "fingertip check fsr400 fsr402 --junit out/checks.xml",
        "fingertip check fsr400 --verbose",
        "fingertip check out/fsr400",
    ),
    "picture": ("fingertip picture fsr400", "fingertip picture adult_finger --filling --out filling.png"),
    "drawing": ("fingertip drawing adult_finger --out out/adult_drawing",),
    "page": ("fingertip page fsr400",),
    "studio": ("fingertip studio fsr400", "fingertip studio mine.toml --port 0 --no-browser"),
    "sheet": ("fingertip sheet fsr400", "fingertip sheet fsr400 --material smooth_sil_940 --out casting.md"),
    "acceptance": ("fingertip acceptance fsr400 --out acceptance.md",),
    "coupon": ("fingertip coupon fsr400",),
    "calibrate": (
        "fingertip calibrate printer fsr400 my_readings.toml --out calibrated.toml",
        "fingertip calibrate sensor my_weighings.csv article --out weighed.toml",
    ),
    "calibrate printer": ("fingertip calibrate printer fsr400 my_readings.toml --out calibrated.toml",),
    "calibrate sensor": ("fingertip calibrate sensor my_weighings.csv article --out weighed.toml",),
    "board": (
        "fingertip board fsr400",
        "fingertip board fsr400 --analysis --plot response.svg --out out/board",
        "fingertip board article --article --out out/article_board",
        "fingertip board fsr400 --check",
    ),
    "firmware": ("fingertip firmware fsr400",),
    "simulate": (
        "fingertip simulate fsr400 --surface smooth --seed 7 --out smooth.csv",
        "fingertip simulate hard_tap --design fsr400 --set tap.force_n=3 --out tap.csv",
    ),
    "detect": (
        "fingertip detect smooth.csv --detector fast",
        "fingertip detect daq.csv --column time_s='Time [s]' --column voltage_v='AI0 (V)'",
    ),
    "validate": ("fingertip validate fsr400 --trials 12 --minutes 1",),
    "sweep": ("fingertip sweep board --out out/sweep", "fingertip sweep --show --out out/sweep"),
    "bench": ("fingertip bench --solvers odeint --seconds 1 --boards 100",),
    "completion": ("fingertip completion bash",),
}
"""Command -> commands to copy."""


def list_examples(command: str) -> tuple[str, ...]:
    """List the examples of a command; of the whole program for an empty name."""
    return EXAMPLES.get(command, ())


MAX_WIDTH = 80
"""Largest width of a help page, in columns: longer lines are hard to read."""
MIN_WIDTH = 40
MAX_TERM = 26
"""Largest width of the column of options; a longer one has a line of its own."""

ARGUMENTS, OPTIONS = "Arguments", "Options"

_METAVARS = {"int": "NUMBER", "integer": "NUMBER", "float": "NUMBER", "path": "PATH"}
"""Name of a type in typer -> what stands for a value on a help page."""


SUBJECTS = {
    "Everything of a design": ("new", "make", "page", "studio", "check", "params"),
    "Parts and mold": ("build", "sheet", "acceptance", "coupon", "calibrate", "picture", "drawing"),
    "Board and controller": ("board", "firmware"),
    "Signal and slip": ("simulate", "detect", "validate"),
    "Many designs, and measurements of the program": ("sweep", "bench"),
    "Editors and shells": ("schema", "completion"),
}
"""Subject on the help page of the program -> its commands."""


class HelpCommand(TyperCommand):
    """Command whose help page this module writes."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help page."""
        formatter.write(format_command(self, ctx))


class HelpGroup(TyperGroup):
    """Group of commands whose help page this module writes."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help page."""
        formatter.write(format_group(self, ctx))


def group_commands(app: typer.Typer) -> None:
    """Give the commands of a program the help pages of this module, each under its subject."""
    subject_of = {name: subject for subject, names in SUBJECTS.items() for name in names}
    for command in app.registered_commands:
        command.cls = HelpCommand
        name = command.name or (command.callback.__name__ if command.callback else "")
        command.rich_help_panel = subject_of.get(name)
    for group in app.registered_groups:
        group.cls = HelpGroup
        group.rich_help_panel = subject_of.get(group.name or "")
        if group.typer_instance:
            group_commands(group.typer_instance)


def format_command(command: Any, ctx: Any, width: int | None = None) -> str:
    """Format the help page of a command: usage, description, arguments, options and examples."""
    width = width or _terminal_width()
    groups: dict[str, list[tuple[str, str]]] = {ARGUMENTS: [], OPTIONS: []}
    common: list[tuple[str, str]] = []
    for parameter in command.get_params(ctx):
        if getattr(parameter, "hidden", False):
            continue
        row = (_term(parameter), _describe(parameter))
        if parameter.param_type_name == "argument":
            groups[ARGUMENTS].append(row)
            continue
        panel = getattr(parameter, "rich_help_panel", None)
        if panel == COMMON or parameter.name == "help":
            common.append(row)
        else:
            groups.setdefault(panel or OPTIONS, []).append(row)
    sections = [(title, rows) for title, rows in [*groups.items(), (COMMON, common)] if rows]
    path = ctx.command_path
    lines = [_wrap(f"Usage: {path} {_usage(command, ctx)}", width, "       "), "", *_paragraphs(command.help, width)]
    for title, rows in sections:
        lines += ["", f"{title}:", *_two_columns(rows, width)]
    if examples := list_examples(_command_name(ctx)):
        lines += ["", "Examples:", *(_wrap(f"  $ {example}", width, "      ") for example in examples)]
    return "\n".join(lines) + "\n"


def format_group(group: Any, ctx: Any, width: int | None = None) -> str:
    """Format the help page of a group: usage, description and its commands, by subject."""
    width = width or _terminal_width()
    subjects: dict[str, list[tuple[str, str]]] = {subject: [] for subject in SUBJECTS}
    for name in group.list_commands(ctx):
        command = group.get_command(ctx, name)
        if command is None or command.hidden:
            continue
        subject = getattr(command, "rich_help_panel", None) or "Commands"
        subjects.setdefault(subject, []).append((name, _first_sentence(command.help or "")))
    subjects = {subject: rows for subject, rows in subjects.items() if rows}
    longest = max((len(name) for rows in subjects.values() for name, _ in rows), default=0)
    lines = [f"Usage: {ctx.command_path} COMMAND [OPTIONS]", "", *_paragraphs(group.help, width)]
    for subject, rows in subjects.items():
        lines += ["", f"{subject}:", *_two_columns(rows, width, longest)]
    options = [(_term(p), _describe(p)) for p in group.get_params(ctx) if p.param_type_name == "option"]
    lines += ["", f"{OPTIONS}:", *_two_columns(options, width)]
    if examples := list_examples(_command_name(ctx)):
        lines += ["", "Examples:", *(_wrap(f"  $ {example}", width, "      ") for example in examples)]
    lines += ["", _wrap(f"`{ctx.command_path} COMMAND --help` describes a command.", width, "")]
    return "\n".join(lines) + "\n"


def _command_name(ctx: Any) -> str:
    """Words of a command behind the name of the program."""
    return "" if ctx.parent is None else f"{_command_name(ctx.parent)} {ctx.info_name}".strip()


def metavar(parameter: Any) -> str:
    """Word that stands for the value of a parameter; empty for a flag, which has none."""
    if parameter.param_type_name == "option" and parameter.is_flag:
        return ""
    if parameter.metavar:
        return str(parameter.metavar)
    if parameter.param_type_name == "argument":
        return str(parameter.name).upper()
    return _METAVARS.get(_type_name(parameter), "TEXT")


def _type_name(parameter: Any) -> str:
    """Name of the type of a parameter's value, in lower case."""
    described = getattr(parameter, "type_descriptor", None)  # typer with its own parser
    if described is not None:
        if described.is_path:
            return "path"
        return str(getattr(described.annotation, "__name__", described.annotation)).lower()
    name = str(getattr(parameter.type, "name", "text")).lower()
    return "path" if name in ("path", "file", "directory") else name


def _term(parameter: Any) -> str:
    """Option or argument as it is typed."""
    word = metavar(parameter)
    if parameter.param_type_name == "argument":
        return f"{word}..." if parameter.nargs != 1 else word
    names = sorted([*parameter.opts, *parameter.secondary_opts], key=lambda name: name.startswith("--"))
    return ", ".join(names) + (f" {word}" if word else "")


def _describe(parameter: Any) -> str:
    """Meaning of a parameter, with its default."""
    text = parameter.help or ""
    default = parameter.default
    shown = isinstance(default, int | float | str) and not isinstance(default, bool)
    if type(default).__name__ == "PosixPath" or type(default).__name__ == "WindowsPath":
        default, shown = default.as_posix(), True
    if shown and default != "":
        text = f"{text} Default: {default}."
    return text


def _usage(command: Any, ctx: Any) -> str:
    """Arguments of a command, in brackets where they may be left out."""
    words = []
    for parameter in command.get_params(ctx):
        if parameter.param_type_name == "argument":
            word = _term(parameter)
            words.append(word if parameter.required else f"[{word}]")
    return " ".join([*words, "[OPTIONS]"])


def _first_sentence(text: str) -> str:
    """First sentence of a description."""
    first = text.split("\n\n")[0]
    end = first.find(". ")
    return first if end < 0 else first[: end + 1]


def _paragraphs(text: str | None, width: int) -> list[str]:
    """Lines of a description, with an empty line between paragraphs."""
    wrapped = [_wrap(" ".join(paragraph.split()), width, "") for paragraph in (text or "").split("\n\n")]
    return "\n\n".join(wrapped).split("\n")


def _two_columns(rows: Sequence[tuple[str, str]], width: int, longest: int = 0) -> Iterable[str]:
    """Lines of a list of terms with their meanings."""
    column = longest or max((len(term) for term, _ in rows if len(term) <= MAX_TERM), default=MAX_TERM)
    indent = " " * (column + 4)
    for term, meaning in rows:
        if len(term) > column:
            yield f"  {term}"
            yield _wrap(indent + meaning, width, indent)
        else:
            yield _wrap(f"  {term:{column}}  {meaning}", width, indent)


def _wrap(text: str, width: int, indent: str) -> str:
    """Break a text into lines between words; a longer word stays whole."""
    return textwrap.fill(
        text,
        width,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
        replace_whitespace=False,
        drop_whitespace=True,
    )


def _terminal_width() -> int:
    """Width of a help page on this terminal."""
    return max(MIN_WIDTH, min(MAX_WIDTH, shutil.get_terminal_size((MAX_WIDTH, 24)).columns))
