"""`python -m fingertip` is the `fingertip` command."""

import os
import sys

from fingertip import __version__
from fingertip.foundation import interruption


def main() -> None:
    """Run the command line, and describe an interruption in one line."""
    interruption.raise_interruptions()
    try:
        try:
            _open_missing_streams()
            _run()
        finally:
            interruption.end_by_default()
    except interruption.INTERRUPTIONS as error:
        raise SystemExit(interruption.report(error)) from None


def _open_missing_streams() -> None:
    """Open the null device for closed standard streams, whose numbers the next files would get."""
    handle = os.open(os.devnull, os.O_RDWR)
    while handle <= 2:
        handle = os.open(os.devnull, os.O_RDWR)

    os.close(handle)
    # Standard input stays None: `detect -` says that it is closed.
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (open until the process ends)
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115


def _run() -> None:
    """Run the command line.

    A program that cannot even be loaded ends with the exit code of a fault too. The version alone
    is told without loading anything.
    """
    if sys.argv[1:] == ["--version"]:
        print(__version__)
        return

    try:
        from fingertip.cli import main as run
    except Exception as error:
        if interruption.find_signal(error) is not None:
            raise SystemExit(interruption.report(error)) from None

        reason = " ".join(str(error).split())
        print(
            f"error: fingertip cannot be loaded ({type(error).__name__}: {reason[:200]}); ",
            end="",
            file=sys.stderr,
        )
        print("install it again, and see that files may be opened (ulimit -n).", file=sys.stderr)
        raise SystemExit(70) from None

    run()


if __name__ == "__main__":
    main()
