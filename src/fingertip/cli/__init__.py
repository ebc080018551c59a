"""Command line: words come in, and a result goes out on stdout, with an exit code.

Each command has a module of its own and imports what it needs when it runs.

>>> from fingertip.cli.design import make_schema
>>> make_schema("surface")["title"]
'fingertip surface'
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Sequence

import typer

from fingertip import __version__
from fingertip.cli.accuracy import accuracy
from fingertip.cli.board import board
from fingertip.cli.build import build, firmware, make, robot
from fingertip.cli.calibrate import calibrate
from fingertip.cli.check import check
from fingertip.cli.compare import compare
from fingertip.cli.completion import VARIABLE, answer_shell
from fingertip.cli.console import Console
from fingertip.cli.design import completion, params, schema
from fingertip.cli.detect import detect, validate
from fingertip.cli.documents import acceptance, drawing, page, picture, sheet, studio
from fingertip.cli.help_page import HelpCommand, HelpGroup
from fingertip.cli.new import new
from fingertip.cli.options import command, flag
from fingertip.cli.pad import pad
from fingertip.cli.recorded_trials import record
from fingertip.cli.simulate import simulate
from fingertip.cli.sweep import sweep
from fingertip.foundation.errors import FingertipError, Issue

app = typer.Typer(
    name="fingertip",
    help="Design a bioinspired, sensorised prosthetic fingertip from one parameter file.",
    cls=HelpGroup,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
COMMANDS: dict[str, tuple[Callable[..., None] | typer.Typer, ...]] = {
    "Make a finger": (new, make, check, compare, studio, build, calibrate),
    "Board, controller and slip": (board, firmware, simulate, detect, validate, record),
    "Many designs": (sweep,),
    "Look up and export": (params, pad, accuracy, robot, schema, completion),
    "What make includes, one by one": (page, sheet, acceptance, picture, drawing),
}
"""Subject on the help page of the program -> its commands."""
for _subject, _commands in COMMANDS.items():
    for _command in _commands:
        if isinstance(_command, typer.Typer):
            app.add_typer(_command, rich_help_panel=_subject)
        else:
            app.command(cls=HelpCommand, rich_help_panel=_subject)(_command)


@app.callback(invoke_without_command=True)
@command
def _version(version: bool = flag("Print the version and exit.")) -> None:
    if version:
        Console().write(__version__)
        raise typer.Exit()


def _refuse_empty_words(words: Sequence[str]) -> None:
    """Refuse an empty word: it is an unset variable of the shell, and as a folder this one."""
    for before, word in zip(["", *words], words, strict=False):
        option, sign, value = word.partition("=")
        if not word or (sign and not value and option.startswith("--")):
            name = option or (before if before.startswith("-") else "argument")
            raise FingertipError(
                Issue(
                    name, "is empty, perhaps a variable that is not set; give a value, or omit it."
                )
            )


@command
def _answer() -> None:
    _refuse_empty_words(sys.argv[1:])
    if VARIABLE in os.environ:
        answer_shell(typer.main.get_command(app))
    else:
        app()


def main() -> None:
    # The linear systems here have some twenty unknowns: threads of the linear algebra library only
    # delay the start.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # The processes that a sweep starts import nothing from the current folder, which may be a
    # stranger's.
    os.environ["PYTHONSAFEPATH"] = "1"
    # The modules loaded so far stay until the end: the garbage collector need not search them again
    # and again.
    gc.freeze()

    try:
        _answer()
    except typer.Exit as end:
        raise SystemExit(end.exit_code) from None
