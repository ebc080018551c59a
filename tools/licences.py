"""Command `python -m tools.licences`: write docs/licences.md from the metadata of what is
installed.

Run it in the .venv of `sh install.sh test`, again whenever constraints.txt changes. The page lists
everything that the core and the extras for users bring. Metadata states the licence of a package,
not of the libraries inside its wheels: `COPYLEFT` names those.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from fingertip.foundation.extras import DISTRIBUTION, EXTRAS

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "licences.md"

COPYLEFT = {
    "cadquery-ocp": "contains Open CASCADE Technology (LGPL-2.1 with the Open CASCADE exception), "
    "FreeImage (FreeImage "
    "Public License or GPL), LibRaw (LGPL-2.1 or CDDL-1.0) and JBIG-KIT (GPL-2.0)",
    "casadi": "LGPL-3.0 or later; contains qpOASES (LGPL-2.1), alpaqa and SLEQP (LGPL-3.0), and "
    "Ipopt, Bonmin, Cbc and "
    "Clp (EPL)",
    "lxml": "contains iconv (LGPL-2.1)",
    "nlopt": "the compiled library is governed by the LGPL-2.1 of its part luksan",
    "nptdms": "LGPL-3.0",
    "numpy": "contains libquadmath (LGPL-2.1) and libgfortran (GPL-3.0 with the GCC runtime "
    "exception)",
    "scipy": "contains libquadmath (LGPL-2.1) and libgfortran (GPL-3.0 with the GCC runtime "
    "exception)",
    "pillow": "contains liblzma; its licence file lists the LGPL-2.1 and the GPL of other parts "
    "of XZ Utils",
}
"""Packages under the LGPL or with a library under it or the GPL
inside, as read in their wheels for Linux.
"""

_LGPL = re.compile(r"(lesser|library) general public|\bLGPL", re.IGNORECASE)

_CLASSIFIED = {
    "Apache Software License": "Apache-2.0",
    "BSD License": "BSD",
    "ISC License (ISCL)": "ISC",
    "MIT License": "MIT",
    "Python Software Foundation License": "PSF-2.0",
}
"""Short names of the classifiers that are used."""

_HEADING = """\
# Licences of the dependencies

For whoever passes an installation on: after this page you know whose terms it must keep to.

fingertip is under Apache-2.0. The packages that it needs keep their own licences. This page lists all that
`pip install "fingertip-kit[all]"` brings, as their metadata states it. `python -m tools.licences` makes the page;
tests compare it with what is installed.

The wheel of fingertip contains none of these packages: pip fetches each from its publisher. Whoever passes on an
installation, such as a container image, also passes on these packages and must keep to their terms. Those of the LGPL
ask, among other things, that the library can be replaced; a Python environment allows that.

## Parts under the LGPL or the GPL
"""  # noqa: E501


_LISTED = (
    "By licence; in parentheses what brings the package, the core or an extra. Without one "
    "it is `cadquery`."
)


@dataclass(frozen=True)
class Licence:
    """Licence of a package, and what asks for the package."""

    name: str
    text: str
    asked_by: str
    """`core`, or the first extra that brings the package."""


def main() -> None:
    """Write the page."""
    try:
        PAGE.write_text(format_page(list_licences()), encoding="utf-8")
    except metadata.PackageNotFoundError as fault:
        remedy = 'run "sh install.sh test" and use the Python of its .venv'
        sys.exit(f"licences: {fault.name} is not installed; {remedy}")

    print(PAGE.relative_to(ROOT))


def list_licences() -> list[Licence]:
    """List the licence of each package of the core and of the extras for users, by name."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    groups = {"core": project["dependencies"]}
    groups |= {
        extra: lines
        for extra, lines in project["optional-dependencies"].items()
        if extra in EXTRAS.values()
    }

    found: dict[str, str] = {}

    for group, lines in groups.items():
        for name in collect(lines) - {DISTRIBUTION}:  # some extras ask for others of its own
            found.setdefault(name, group)

    return [
        Licence(metadata.metadata(name)["Name"], read_licence(name), found[name])
        for name in sorted(found)
    ]


def collect(requirements: Iterable[str]) -> set[str]:
    """Collect the packages that requirements bring on this machine,
    with all that those ask for, by canonical name.
    """
    waiting = [Requirement(line) for line in requirements]
    done: set[tuple[str, frozenset[str]]] = set()

    while waiting:
        requirement = waiting.pop()
        extras = frozenset(requirement.extras) or frozenset({""})
        one = (canonicalize_name(requirement.name), extras)
        if one in done:
            continue

        done.add(one)
        for line in metadata.requires(requirement.name) or ():
            asked = Requirement(line)
            if asked.marker is None or any(
                asked.marker.evaluate({"extra": extra}) for extra in extras
            ):
                waiting.append(asked)

    return {name for name, _ in done}


def read_licence(name: str) -> str:
    """Read the licence that a package states: as an expression, as a classifier, or in one line."""
    stated = metadata.metadata(name)
    if "License-Expression" in stated:
        return stated["License-Expression"]

    classifiers = [
        line.rsplit(" :: ", 1)[-1]
        for line in stated.get_all("Classifier") or ()
        if "License ::" in line
    ]
    known = [_CLASSIFIED[one] for one in classifiers if one in _CLASSIFIED]
    if known:
        return " AND ".join(known)

    text = stated["License"].strip() if "License" in stated else ""
    if text and "\n" not in text:
        return text

    sys.exit(
        f"licences: {name} states no licence in a form that is known; read its files and add it "
        "to this script"
    )


def mentions_lgpl(name: str) -> bool:
    """Tell whether metadata or a licence file of a package names the LGPL."""
    if _LGPL.search(read_licence(name)):
        return True

    files = [file for file in metadata.distribution(name).files or () if ".dist-info" in str(file)]
    paths = [
        Path(str(file.locate()))
        for file in files
        if re.search(r"licen|copying|notice", file.name, re.IGNORECASE)
    ]
    return any(_LGPL.search(path.read_text(encoding="utf-8", errors="replace")) for path in paths)


def format_page(licences: Iterable[Licence]) -> str:
    """Format the page."""
    licences = list(licences)
    special = [
        f"- **{one.name}**: {COPYLEFT[canonicalize_name(one.name)]}."
        for one in licences
        if canonicalize_name(one.name) in COPYLEFT
    ]
    by_text: dict[str, list[str]] = {}

    for one in licences:
        by_text.setdefault(one.text, []).append(
            one.name if one.asked_by == "cadquery" else f"{one.name} ({one.asked_by})"
        )

    rows = [
        f"- {text}: {', '.join(names)}"
        for text, names in sorted(by_text.items(), key=lambda each: each[0].lower())
    ]
    return "\n".join([_HEADING, *special, "", "## All packages", "", _LISTED, "", *rows, ""])


if __name__ == "__main__":
    main()
