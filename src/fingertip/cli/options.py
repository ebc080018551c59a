"""Options of all commands, their decorator, loading of designs, checks of file names."""

from __future__ import annotations

import functools
import inspect
import itertools
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli.completion import COMPLETIONS
from fingertip.cli.console import (
    BAD_INPUT,
    FAULT,
    Console,
    describe_fault,
    describe_path_error,
    discard_stdout,
)
from fingertip.foundation import interruption
from fingertip.foundation.errors import (
    DesignError,
    FingertipError,
    Issue,
    OutputError,
    raise_issues,
)
from fingertip.foundation.extras import describe_import_error

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.design.design_file import LoadedTables
    from fingertip.design.finger_set import FingerSet

PIPE_CLOSED = 141
COMMON = "Options of all commands"
"""Heading of these options on the help pages."""

JSON = typer.Option(
    False,
    "--json",
    rich_help_panel=COMMON,
    help="Print one JSON object to stdout and nothing else.",
)
FIT = typer.Option(
    False, "--fit", help="Move what follows from the sizes until the design can be made; list it."
)
QUIET = typer.Option(
    False,
    "--quiet",
    "-q",
    rich_help_panel=COMMON,
    help="Print no progress and no messages on stderr, only errors; the result still goes to "
    "stdout.",
)
VERBOSE = typer.Option(
    False, "--verbose", "-v", help="Print the details too, not only the verdict."
)
FORCE = typer.Option(
    False,
    "--force",
    help="Overwrite files that fingertip did not write, or that were changed since.",
)
JOBS = typer.Option(None, help="Number of worker processes. Default: one per processor.")
CHANGES = typer.Option(
    None, "--set", metavar="TABLE.KEY=VALUE", help="Change a parameter of the design; repeatable."
)


def parse_design(typed: str) -> Path:
    """Parse the path or the bundled name of a design or a set."""
    from fingertip.catalogues.file_kinds import DESIGN, SET, parse_source

    return parse_source(typed, DESIGN, SET)


DESIGN_FILE = typer.Argument(
    parser=parse_design, help="Design file, or a bundled design such as fsr400 or adult_finger."
)
OPTIONAL_DESIGN = typer.Argument(
    None, parser=parse_design, help="Design file or bundled name; the default design if left out."
)
DESIGN_FILES = typer.Argument(
    metavar="DESIGN",
    parser=parse_design,
    help="Files or bundled names of designs and sets; or folders, to compare with their manifests.",
)
_OFFER = re.compile(r", or add --fit, which moves .*\.$")
_ONLY_FIT = re.compile(r"; (?:add )?--fit(,? )")
"""Offers of a fit, beside another remedy and alone, for commands without --fit."""
_FITTED_FILE = r"; `fingertip params DESIGN --fit --toml > fitted.toml`\1"
_FITTED = (DESIGN_FILE, OPTIONAL_DESIGN, DESIGN_FILES)
"""Arguments of the commands that have the option --fit."""
MATERIAL = typer.Option(
    None, help="Silicone: {silicones}; the design's silicone.product if omitted."
)
CALIBRATED_DESIGN = typer.Option(
    None,
    "--out",
    "-o",
    metavar="FILE",
    help="File for the calibrated design, a complete design file.",
)
FORCE_CALIBRATED = typer.Option(False, "--force", help="Overwrite FILE if it exists.")


def flag(text: str) -> Any:
    """Declare an option that is off unless it is given, by the name of its parameter."""
    return typer.Option(False, help=text)


_OUTPUT_OPTIONS = [
    inspect.Parameter(
        name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=option, annotation=bool
    )
    for name, option in (("as_json", JSON), ("quiet", QUIET))
]


def command(function: Callable[..., None]) -> Callable[..., None]:
    """Decorate a command: print the issues of an error and exit with `BAD_INPUT`, or at an
    interruption with its code.

    What no command expects ends with `FAULT`: never with the exit code of a failed check, as a
    traceback would. A command with a parameter `console` gets one, and has the options --json and
    --quiet, and --fit if it takes a design.
    """
    # The help page would keep the line breaks of the source within a paragraph.
    paragraphs = inspect.cleandoc(function.__doc__ or "").split("\n\n")
    function.__doc__ = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    signature = inspect.signature(function, eval_str=True)
    own = signature.parameters
    declared = [parameter for name, parameter in own.items() if name != "console"]
    if "console" in own:
        declared += _OUTPUT_OPTIONS
    takes_design = any(
        parameter.default is argument
        for parameter, argument in itertools.product(declared, _FITTED)
    )
    if takes_design:
        declared.append(
            inspect.Parameter(
                "fit", inspect.Parameter.POSITIONAL_OR_KEYWORD, default=FIT, annotation=bool
            )
        )

    for parameter in declared:
        option = parameter.default
        name = parameter.name
        if not option.metavar and isinstance(option, typer.models.ArgumentInfo):
            option.metavar = name.upper()
        if option.default is False and not option.param_decls:
            option.param_decls = (f"--{name.replace('_', '-')}",)

        option.autocompletion = (
            option.autocompletion
            or COMPLETIONS.get(f"{function.__name__} {name}")
            or COMPLETIONS.get(name)
        )

    @functools.wraps(function)
    def run(**words: Any) -> None:
        console = Console(
            bool(words.get("as_json")), bool(words.get("quiet")), bool(words.get("fit"))
        )
        arguments = {
            name: value for name, value in {**words, "console": console}.items() if name in own
        }
        try:
            function(**arguments)
        except (typer.Exit, typer.Abort):
            raise
        except BrokenPipeError:
            discard_stdout()
            raise typer.Exit(PIPE_CLOSED) from None
        except (Exception, *interruption.INTERRUPTIONS) as error:
            if interruption.find_signal(error) is not None:
                console.clear()
                raise typer.Exit(interruption.report(error)) from None

            refusal = _find_refusal(error)
            if refusal and "fit" not in words:
                refusal = FingertipError(map(_leave_out_fit, refusal.issues))

            console.print_issues(refusal or describe_fault(error))
            raise typer.Exit(BAD_INPUT if refusal else FAULT) from None

    run.__annotations__ = {parameter.name: parameter.annotation for parameter in declared}
    run.__signature__ = signature.replace(parameters=declared)  # type: ignore[attr-defined]
    return run


def _leave_out_fit(issue: Issue) -> Issue:
    """Leave the offer of --fit out of an issue of a command that has no such option."""
    message = _OFFER.sub(".", issue.message)
    return replace(issue, message=_ONLY_FIT.sub(_FITTED_FILE, message))


def _find_refusal(error: BaseException) -> FingertipError | None:
    """Return the issues of an error about input, a path or a package; None for a fault."""
    if isinstance(error, FingertipError):
        return error

    return describe_path_error(error) or describe_import_error(error)


def load_design(
    file: Path | None,
    changes: Sequence[str] | None,
    console: Console | None = None,
    may_be_empty: bool = True,
) -> Design:
    """Load a design, or the default one, with changes; with --fit, fit it.

    Raises DesignError.
    """
    if console and console.fits:
        from fingertip.design.design_file import load_tables
        from fingertip.fitting.fitting import fit_tables

        loaded = load_tables([file] if file else [], changes or ())
        design = fit_tables(
            loaded.tables,
            before=loaded.before,
            changed=loaded.changed,
            progress=console.progress,
            provisional=loaded.provisional,
        )
        console.show_moves(design.name, design.moves)
    else:
        design, is_default = read_design(file, tuple(changes or ()))
        if file and is_default and not may_be_empty:
            message = (
                "sets no parameter, so it would be fsr400; state what differs, at least its name."
            )
            raise DesignError(Issue(str(file), message))

        if file and is_default and console:
            console.progress(f"{file} sets no parameter: this is the default design, fsr400")

    if console and design.provisional:
        from fingertip.design.hand_sizes import describe_guesses

        guesses = describe_guesses(design.provisional)
        if guesses:
            console.progress(f"note: {guesses}")

    return design


def find_folders(paths: Iterable[Path], console: Console) -> list[Path]:
    """Find the folders among designs; a bundled name wins over a folder."""
    from fingertip.catalogues.file_kinds import DESIGN, SET, is_bundled_name

    folders = [path for path in paths if path.is_dir()]
    bundled = [path for path in folders if is_bundled_name(path, DESIGN, SET)]
    console.warn(
        f"{path} is the bundled design of this name; ./{path} names the folder" for path in bundled
    )

    return [path for path in folders if path not in bundled]


def list_words(changes: Iterable[str], console: Console) -> list[str]:
    """List the options that change a design, for a command to type."""
    words = list[str]()
    for change in changes:
        words += ["--set", change]

    return [*words, "--fit"] if console.fits else words


def read_design(file: Path | None, changes: tuple[str, ...]) -> tuple[Design, bool]:
    """Read a design, and whether its file leaves it the default one. Raises DesignError."""
    from fingertip.design import Design
    from fingertip.design.design_file import load_tables

    loaded = load_tables([file] if file else [], changes)
    design = Design.from_tables(loaded.tables, loaded.before, loaded.changed, loaded.provisional)
    return design, not loaded.before


def load_fingers(file: Path, changes: Sequence[str] | None, console: Console) -> FingerSet:
    """Load a set of fingers; with --fit, fit each. Raises DesignError."""
    from fingertip.catalogues.electronics import split_finger
    from fingertip.design.finger_set import build_set, load_set, read_set
    from fingertip.fitting.fitting import fit_tables

    if not console.fits:
        return load_set(file, changes or ())

    typed = {split_finger(change.partition("=")[0].strip())[1] for change in changes or ()}

    def fit(loaded: LoadedTables) -> Design:
        # A fit may move what the set's file states.
        changed = [name for name in loaded.changed if name in typed]
        return fit_tables(
            loaded.tables,
            before=loaded.before,
            changed=changed,
            progress=console.progress,
            provisional=loaded.provisional,
        )

    fingers = build_set(*read_set(file, changes or (), fit))
    for form in fingers.forms:
        console.show_moves(form.design.name, form.design.moves)

    return fingers


# Names of files that a command is asked to write: what is wrong with them is found before any work
# starts.


def refuse(*issues: Iterable[Issue]) -> None:
    raise_issues(OutputError, *issues)


def find_idle_issues(mode: str, options: Mapping[str, object]) -> Iterator[Issue]:
    """Yield an issue for each option that has no effect as nothing is written."""
    for name, value in options.items():
        if value:
            yield Issue(
                name, f"has no effect with {mode}, which writes nothing; leave one of them out."
            )


def find_file_issues(
    option: str,
    path: Path | None,
    *suffixes: str,
    inputs: Iterable[Path | None] = (),
    kept: str = "",
) -> Iterator[Issue]:
    """Yield an issue if a file cannot be written: folder, wrong suffix, input, or place."""
    from fingertip.foundation.output_set import find_place_issues

    if path is None:
        return

    remedy = f"choose another file with {option}"
    if os.path.isdir(path):
        yield Issue(str(path), f"is a folder; {remedy}.")
    elif path.suffix.lower() not in suffixes:
        yield Issue(
            option,
            f"{path.name!r} is of no format that is written; end it in {' or '.join(suffixes)}.",
        )
    elif os.path.exists(path) and any(_is_same_file(path, file) for file in inputs):
        yield Issue(option, f"{path} is an input of this command; give another name.")
    elif kept and os.path.lexists(path):
        yield Issue(str(path), f"exists and is not overwritten; {remedy}, or {kept}.")
    else:
        yield from find_place_issues(path.parent, remedy, path.name)


def _is_same_file(path: Path, file: Path | None) -> bool:
    return bool(file and os.path.exists(file) and path.samefile(file))
