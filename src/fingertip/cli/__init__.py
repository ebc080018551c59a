"""Command line. Each command has a module of its own and imports what it needs when it runs."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable

import typer

from fingertip._version import __version__
from fingertip.cli.acceptance import acceptance
from fingertip.cli.bench import bench
from fingertip.cli.board import board
from fingertip.cli.build import build
from fingertip.cli.calibrate import calibrate
from fingertip.cli.calibrate_sensor import sensor
from fingertip.cli.check import check
from fingertip.cli.completion import completion
from fingertip.cli.console import Console, command
from fingertip.cli.coupon import coupon
from fingertip.cli.detect import detect
from fingertip.cli.drawing import drawing
from fingertip.cli.help_page import HelpCommand, HelpGroup
from fingertip.cli.make import make
from fingertip.cli.new import new
from fingertip.cli.page import page
from fingertip.cli.params import params
from fingertip.cli.picture import picture
from fingertip.cli.schema import schema
from fingertip.cli.sheet import sheet
from fingertip.cli.simulate import simulate
from fingertip.cli.sweep import sweep
from fingertip.cli.validate import validate

app = typer.Typer(
    name="fingertip",
    help="Design a bioinspired, sensorised prosthetic fingertip from one parameter file.",
    cls=HelpGroup,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
calibrate.command("sensor", cls=HelpCommand)(sensor)

SUBJECTS: dict[str, tuple[Callable[..., None] | typer.Typer, ...]] = {
    "Everything of a design": (new, params, make, page, check),
    "Parts and mold": (build, picture, drawing, sheet, acceptance, coupon, calibrate),
    "Board": (board,),
    "Signal and slip": (simulate, detect, validate),
    "Many designs, and measurements of the program": (sweep, bench),
    "Editors and shells": (schema, completion),
}
"""Subject on the help page -> its commands."""

for _subject, _commands in SUBJECTS.items():
    for _command in _commands:
        if isinstance(_command, typer.Typer):
            app.add_typer(_command, name="calibrate", cls=HelpGroup, rich_help_panel=_subject)
        else:
            app.command(cls=HelpCommand, rich_help_panel=_subject)(_command)


@app.callback(invoke_without_command=True)
@command
def _version(version: bool = typer.Option(False, "--version", help="Print the version and exit.")) -> None:
    if version:
        Console(False, False).write(__version__)
        raise typer.Exit()


def main() -> None:
    """Entry point of the `fingertip` command."""
    # The linear systems here have some twenty unknowns: threads of the linear algebra library only delay the start.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # The modules loaded so far stay until the end: the garbage collector need not search them again and again.
    gc.freeze()
    app()
