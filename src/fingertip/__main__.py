"""`python -m fingertip` is the `fingertip` command."""

import sys

from fingertip import interruption


def main() -> None:
    """Run the command line, and describe an interruption in one line."""
    interruption.raise_interruptions()
    try:
        try:
            _run()
        finally:
            interruption.end_by_default()
    except interruption.INTERRUPTIONS as error:
        raise SystemExit(interruption.report(error)) from None


def _run() -> None:
    """Run the command line. A program that cannot even be loaded ends with the exit code of a fault too."""
    try:
        from fingertip.cli import main as run
    except Exception as error:
        if interruption.find_signal(error) is not None:
            raise SystemExit(interruption.report(error)) from None
        reason = " ".join(str(error).split())
        print(f"error: fingertip cannot be loaded ({type(error).__name__}: {reason[:200]}); ", end="", file=sys.stderr)
        print("install it again, and see that files may be opened (ulimit -n).", file=sys.stderr)
        raise SystemExit(70) from None
    run()


if __name__ == "__main__":
    main()
