"""Command `python -m tools.grain`: print how dense the code is beside the last release.

python -m tools.grain                                    beside the newest tag v*
python -m tools.grain --beside COMMIT                    beside another commit
python -m tools.grain --tests FILE --tests-beside FILE   with the seconds of the tests, from the
                                                         files of `pytest --junit-xml=FILE`

Paste what it prints into a pull request. It has no limits, and the exit code says nothing about
the figures.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from tools.grain import GrainError
from tools.grain.junit import read_seconds
from tools.grain.snapshots import find_last_release, read_checkout, read_commit
from tools.grain.tables import write_code_table, write_text_table

ROOT = Path(__file__).resolve().parents[2]

NO_RELEASE = "There is no tag v* to compare with: name a commit with --beside."
NO_TESTS = "Seconds of the tests are left out: name a JUnit file with --tests."


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.grain",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--beside", metavar="COMMIT", help="commit or tag to compare with")
    parser.add_argument("--tests", type=Path, metavar="FILE", help="JUnit file of the tests now")
    parser.add_argument(
        "--tests-beside",
        type=Path,
        metavar="FILE",
        help="JUnit file of the tests of the other commit",
    )
    given = parser.parse_args(arguments)

    try:
        print(write_report(ROOT, given.beside, given.tests, given.tests_beside), end="")
    except GrainError as error:
        sys.exit(f"grain: {error}")


def write_report(
    root: Path,
    beside: str | None,
    tests: Path | None,
    tests_beside: Path | None,
) -> str:
    """Write the report on a checkout."""
    seconds = [read_seconds(file) if file else None for file in (tests, tests_beside)]
    snapshots = [read_checkout(root)]
    other = find_last_release(root) if beside is None else beside
    if other is not None:
        snapshots.append(read_commit(root, other))
    elif tests_beside is not None:
        raise GrainError("--tests-beside has no commit to belong to; add --beside COMMIT")

    report = [
        write_code_table(snapshots),
        write_text_table(snapshots, seconds[: len(snapshots)]),
    ]
    if other is None:
        report.append(f"{NO_RELEASE}\n")
    if tests is None:
        report.append(f"{NO_TESTS}\n")
    return "\n".join(report)


if __name__ == "__main__":
    main()
