"""What `python -m benchmarks.peers` and `.slip` share: the
options of output, and errors as sentences.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

import typer

from fingertip.cli.console import BAD_INPUT, Console
from fingertip.foundation.errors import FingertipError


def answer(
    parser: argparse.ArgumentParser,
    run: Callable[[argparse.Namespace, Console], None],
    words: Sequence[str] | None = None,
) -> None:
    """Parse the words of a command and run it; ends with the exit
    code of a `fingertip` command if it fails.
    """
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object to stdout and nothing else"
    )
    parser.add_argument("--quiet", "-q", action="store_true", help="print no progress")
    options = parser.parse_args(words)
    console = Console(options.json, options.quiet)

    try:
        run(options, console)
    except FingertipError as error:
        console.print_issues(error)
        sys.exit(BAD_INPUT)
    except typer.Exit as end:
        sys.exit(end.exit_code)
