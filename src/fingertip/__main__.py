"""`python -m fingertip` is the `fingertip` command."""

import sys


def main() -> None:
    """Run the command line. A program that cannot even be loaded ends with the exit code of a fault too."""
    try:
        from fingertip.cli import main as run
    except Exception as error:
        reason = " ".join(str(error).split())
        print(f"error: fingertip cannot be loaded ({type(error).__name__}: {reason[:200]}); ", end="", file=sys.stderr)
        print("install it again, and see that files may be opened (ulimit -n).", file=sys.stderr)
        raise SystemExit(70) from None
    run()


if __name__ == "__main__":
    main()
