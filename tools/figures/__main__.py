"""Command `python -m tools.figures`: list figures of the pages that are old, or renew them.

python -m tools.figures                   lists what is old; exit code 1 if anything is
python -m tools.figures renew NAME...     runs the commands of entries, corrects pages and manifest
"""

from __future__ import annotations

import argparse
import sys

from tools.figures.manifest import FILE, find_problems, read_manifest
from tools.figures.renewal import RenewalError, renew


def main() -> None:
    """List, or renew."""
    entries = {entry.name: entry for entry in read_manifest(FILE.read_text(encoding="utf-8"))}
    parser = argparse.ArgumentParser(
        prog="python -m tools.figures",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("action", nargs="?", choices=["list", "renew"], default="list")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(entries))
    given = parser.parse_args()
    unknown = sorted(set(given.names) - set(entries))

    if unknown:
        parser.error(
            f"there are no figures {', '.join(unknown)}; choose among {', '.join(entries)}"
        )
    if given.action == "renew" and not given.names:
        parser.error(f"renew takes one name or several of {', '.join(entries)}")

    if given.action == "renew":
        for name in given.names:
            print(f"{name}: {'; '.join(entries[name].commands.values())}", file=sys.stderr)
            try:
                renew(entries[name])
            except RenewalError as fault:
                sys.exit(f"figures: {fault}")

        return

    problems = list(find_problems(list(entries.values())))
    print(
        *problems or ["all figures are current, or say on their page that they are not"], sep="\n"
    )
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
