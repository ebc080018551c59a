"""Help pages: width, groups, examples that run, flags without a
type; and lines that a terminal can hold.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import typer.main

from fingertip.cli import app
from fingertip.cli.console import fit_width
from fingertip.cli.help_page import MAX_WIDTH, load_examples
from tests.approved import check_text
from tests.conftest import run_fingertip

APPROVED = Path(__file__).parents[1] / "approved"
ROOT_COMMAND: Any = typer.main.get_command(app)


def commands(group: Any = ROOT_COMMAND, prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, command in group.commands.items():
        yield f"{prefix}{name}", command
        if hasattr(command, "commands"):
            yield from commands(command, f"{prefix}{name} ")


COMMANDS = dict(commands())


def describe_option(option: Any) -> str:
    default = option.default.as_posix() if isinstance(option.default, Path) else option.default
    kind = getattr(option, "type", option)  # of typer before 0.29, which has the bounds
    low, high = (getattr(kind, name, None) for name in ("min", "max"))
    value = "" if default is None or default is False else f"={default!r}"
    bounds = f" from {low} to {high}" if (low, high) != (None, None) else ""
    return f"{option.opts[0]}{value}{bounds}"


def test_help_pages_fit_and_show_every_option_and_examples() -> None:
    """What is there if an option is left out is the approved value."""
    assert set(load_examples()) == {"", *COMMANDS}
    wrong = []
    defaults = []
    for name, command in {"": ROOT_COMMAND, **COMMANDS}.items():
        done = run_fingertip(*name.split(), "--help")
        page = done.stdout
        listed = [each for each in command.params if each.param_type_name == "option"]
        defaults.append(
            f"{name} {', '.join(describe_option(each) for each in listed if each.name != 'help')}\n"
        )
        options = [one for each in listed for one in each.opts]
        wrong += [
            (name, one)
            for one in options
            if not re.search(rf"(^|[ ,]){one}([ ,]|$)", page, re.MULTILINE)
        ]
        wrong += [(name, line) for line in page.splitlines() if len(line) > MAX_WIDTH]
        wrong += [(name, python_type) for python_type in re.findall(r"<\w+>", page)]
        given = [one for each in command.params if (one := each.default) and one is not True]
        wrong += [(name, one) for one in given if f"Default: {one}." not in " ".join(page.split())]
        if done.returncode or "Examples:\n  $ fingertip " not in page:
            wrong.append((name, done.stderr))
    assert wrong == []
    check_text(APPROVED / "options.txt", "".join(defaults))


def test_examples_are_understood() -> None:
    """Every word of an example is a command, an option or a value;
    tests/test_readme.py runs most of them.
    """
    wrong = []
    for example in (example for group in load_examples().values() for example in group):
        program, *words = shlex.split(example)
        group: Any = ROOT_COMMAND
        name = ""
        try:
            while words and hasattr(group, "commands"):
                name, *words = words
                group = group.commands[name]
            group.make_context(name, words)
        except (KeyError, click.UsageError) as error:
            wrong.append((example, error))
        if program != "fingertip":
            wrong.append((example, program))
    assert wrong == []


def test_a_narrow_terminal_gets_a_narrow_page() -> None:
    parent = ROOT_COMMAND.make_context("fingertip", [], resilient_parsing=True, terminal_width=60)
    command = COMMANDS["build"]
    page = command.get_help(command.make_context("build", ["fsr400"], parent=parent))
    assert max(map(len, page.splitlines())) <= 60


def test_lines_break_between_words_below_the_last_column() -> None:
    table = (
        "R1         2375.4 ohm  first stage\nR8 C9      1k 330n     tactile voltage, the "
        "first anti-aliasing pole"
    )
    assert fit_width(table, 200) == table
    assert fit_width(table, 60).splitlines() == [
        "R1         2375.4 ohm  first stage",
        "R8 C9      1k 330n     tactile voltage, the first",
        "                       anti-aliasing pole",
    ]
    assert fit_width("x" * 70, 60) == "x" * 70
