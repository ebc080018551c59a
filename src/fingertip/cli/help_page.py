"""Help pages: plain text of 80 columns, options in groups, and examples to copy.

typer draws help pages in boxes, with a type beside each flag. These classes write plain text with
click's formatter, from the attributes of the parameters that all versions of typer share.
"""

from __future__ import annotations

import functools
import shutil
import sys
import textwrap
import tomllib
from pathlib import Path
from typing import Any, NoReturn, cast

from typer.core import TyperCommand, TyperGroup

from fingertip.cli.completion import fill_lists, first_sentence
from fingertip.cli.console import BAD_INPUT, Console
from fingertip.cli.options import COMMON
from fingertip.foundation.errors import FingertipError, Issue

MAX_WIDTH = 80
"""Largest width of a help page, in columns: longer lines are hard to read."""
MIN_WIDTH = 40
MAX_TERM = 26
"""Largest width of the column of options; a longer one has a line of its own."""
_METAVARS = dict.fromkeys(("int", "integer", "float"), "NUMBER") | dict.fromkeys(
    ("path", "file", "directory"), "PATH"
)
"""Name of a type in typer -> what stands for a value on a help page."""

MOVED = {
    "bench": "`fingertip accuracy` states the errors of the simulation; in a clone, `python -m "
    "benchmarks.peers` "
    "compares it with other solvers, and `python -m benchmarks.slip` the slip detectors with "
    "others."
}
"""Former command -> where its work is done now."""


@functools.cache
def load_examples() -> dict[str, list[str]]:
    """Load the commands to copy: command -> its examples."""
    text = Path(__file__).with_name("examples.toml").read_text(encoding="utf-8")
    return cast(dict[str, list[str]], tomllib.loads(text))


class HelpCommand(TyperCommand):
    """Command whose help page this module writes."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse words; an error without a command is one of this command."""
        try:
            return super().parse_args(ctx, args)
        except Exception as error:
            if getattr(error, "ctx", ctx) is None:
                vars(error)["ctx"] = ctx

            raise

    def format_help(self, ctx: Any, formatter: Any) -> None:
        groups: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": [], COMMON: []}
        usage = []
        parameter: Any

        for parameter in self.get_params(ctx):
            row = (_term(parameter), _describe(parameter))
            if parameter.param_type_name == "argument":
                groups["Arguments"].append(row)
                usage.append(row[0] if parameter.required else f"[{row[0]}]")
            else:
                is_common = (
                    getattr(parameter, "rich_help_panel", None) == COMMON
                    or parameter.name == "help"
                )
                groups[COMMON if is_common else "Options"].append(row)

        if ctx.info_name == "new":
            from fingertip.design.hand_sizes import SIZES

            title = "Sizes in --hand FILE; `fingertip picture adult_finger --measure` draws them"
            groups[title] = [
                (f"{size['letter']} {name}", size["place"]) for name, size in SIZES.items()
            ]
            groups[title].append(("  knuckle, pin", "tongue or fork; steel, or printed"))

        _write_page(
            self,
            ctx=ctx,
            formatter=formatter,
            usage=" ".join([*usage, "[OPTIONS]"]),
            sections=groups,
        )


class HelpGroup(TyperGroup):
    """Group of commands with help page and errors as those of its commands."""

    def main(self, *args: Any, **extra: Any) -> NoReturn:
        """Run the program; unknown words become an issue, none give the help page."""
        try:
            raise SystemExit(super().main(*args, **extra | {"standalone_mode": False}))
        except FingertipError as error:
            Console().print_issues(error)
            raise SystemExit(BAD_INPUT) from None
        except Exception as error:
            if not hasattr(error, "format_message"):
                raise

            message = error.format_message()
            possible = getattr(error, "possibilities", None)
            if possible:  # versions of typer differ in how they say so
                message = (
                    f"{getattr(error, 'message', '')}. Did you mean "
                    f"{' or '.join(sorted(possible))}?"
                )

            if type(error).__name__ == "NoArgsIsHelpError":
                print(message, file=sys.stderr)
            else:
                path = getattr(getattr(error, "ctx", None), "command_path", "fingertip")
                problem = f"{message[:1].lower()}{message[1:]}".rstrip(".")
                if not message.endswith("?"):
                    problem += ";"

                text = f"{problem} `{path} --help` lists what it takes."
                Console().print_issues(FingertipError(Issue(path, text)))

            raise SystemExit(BAD_INPUT) from None

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find a command by its words. Raises FingertipError for one of `MOVED`."""
        if ctx.parent is None and args[0] in MOVED:
            raise FingertipError(Issue(f"{ctx.command_path} {args[0]}", MOVED[args[0]]))

        return super().resolve_command(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        subjects: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            command: Any = self.get_command(ctx, name)
            subject = getattr(command, "rich_help_panel", None) or "Commands"
            subjects.setdefault(subject, []).append((name, first_sentence(command.help or "")))

        width = max(len(name) for rows in subjects.values() for name, _ in rows)
        sections = {
            subject: [(f"{name:{width}}", text) for name, text in rows]
            for subject, rows in subjects.items()
        }
        options = [
            (_term(parameter), _describe(parameter))
            for parameter in self.get_params(ctx)
            if parameter.param_type_name == "option"
        ]
        _write_page(
            self,
            ctx=ctx,
            formatter=formatter,
            usage="COMMAND [OPTIONS]",
            sections={**sections, "Options": options},
        )
        formatter.write_paragraph()
        formatter.write_text(f"`{ctx.command_path} COMMAND --help` describes a command.")


def _write_page(
    command: Any,
    ctx: Any,
    formatter: Any,
    usage: str,
    sections: dict[str, list[tuple[str, str]]],
) -> None:
    columns = ctx.terminal_width or shutil.get_terminal_size().columns
    formatter.width = max(MIN_WIDTH, min(MAX_WIDTH, columns))
    formatter.write_usage(ctx.command_path, usage)
    formatter.write_paragraph()
    formatter.write_text(command.help or "")

    for title, rows in sections.items():
        if rows:
            with formatter.section(title):
                widths = [len(term) for term, _ in rows if len(term) <= MAX_TERM]
                formatter.write_dl(rows, col_max=max(widths, default=MAX_TERM))

    formatter.write("\nExamples:\n")
    for example in load_examples()[_command_name(ctx)]:
        # A word to copy stays whole.
        lines = textwrap.wrap(
            f"  $ {example}",
            formatter.width,
            subsequent_indent=" " * 6,
            break_long_words=False,
            break_on_hyphens=False,
        )
        formatter.write("\n".join([*lines, ""]))


def _command_name(ctx: Any) -> str:
    """Return the words of a command behind the name of the program."""
    return "" if ctx.parent is None else f"{_command_name(ctx.parent)} {ctx.info_name}".strip()


def metavar(parameter: Any) -> str:
    """Return the word for the value of a parameter; empty for a flag."""
    if parameter.param_type_name == "option" and parameter.is_flag:
        return ""
    if parameter.metavar:
        return str(parameter.metavar)

    descriptor = getattr(parameter, "type_descriptor", None)  # typer with its own parser
    if descriptor:
        kind = getattr(descriptor.annotation, "__name__", "")
    else:
        kind = getattr(parameter.type, "name", "")

    return _METAVARS.get(kind.lower(), "TEXT")


def _term(parameter: Any) -> str:
    word = metavar(parameter)
    if parameter.param_type_name == "argument":
        return f"{word}..." if parameter.nargs != 1 else word

    names = sorted(
        [*parameter.opts, *parameter.secondary_opts], key=lambda name: name.startswith("--")
    )
    return ", ".join(names) + (f" {word}" if word else "")


def _describe(parameter: Any) -> str:
    text = fill_lists(parameter.help or "")
    default = parameter.default
    if isinstance(default, Path):
        default = default.as_posix()

    is_shown = (
        isinstance(default, int | float | str) and not isinstance(default, bool) and default != ""
    )
    return f"{text} Default: {default}." if is_shown else text
