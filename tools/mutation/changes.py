"""Command `python tools/mutation/changes.py COUNT SEED`: draw mutants over all lines of src, each
printed as JSON.

Run it with a Python that has cosmic-ray; it needs nothing of this repository. The number of mutants
of each package (folder of src/fingertip) is in proportion to its lines; the modules beside the
folders count as one package. Within a package, each line on which something can be changed is as
likely as any other, and so is each change on that line. A third word restricts the draw to
packages, separated by commas.
"""

from __future__ import annotations

import ast
import json
import random
import re
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2] / "src" / "fingertip"
LEFT_OUT = (
    # nobody mistypes so
    r"core/ReplaceBinaryOperator_.*_(Mod|FloorDiv|Pow|RShift|LShift|BitAnd|BitOr|BitXor)",
    r"core/ReplaceBinaryOperator_BitOr_.*",  # of annotations, which cannot fail
    r"core/ReplaceComparisonOperator_.*_Is.*",  # identity of small numbers is equality
    r"core/ReplaceTrueWithFalse",  # strict=True is no behaviour
)


def main() -> None:
    """Draw and print."""
    # mypy sees no cosmic-ray here: it is in another environment.
    from cosmic_ray.plugins import get_operator, operator_names

    count = int(sys.argv[1])
    seed = int(sys.argv[2])
    only = set(sys.argv[3].split(",")) if len(sys.argv) > 3 else None
    kinds = {name: get_operator(name) for name in sorted(operator_names())}
    kinds = {
        name: kind
        for name, kind in kinds.items()
        if not kind.arguments() and not any(re.fullmatch(one, name) for one in LEFT_OUT)
    }
    sizes = count_lines()
    total = sum(sizes.values())

    for package, lines in sorted(sizes.items()):
        if only is None or package in only:
            share = lines / (total if only is None else sum(sizes[one] for one in only))
            for mutant in draw(
                package, round(share * count), random.Random(f"{seed} {package}"), kinds
            ):
                print(json.dumps(mutant), flush=True)


def name_package(path: Path) -> str:
    """Return the folder of a module, or "top" for the modules beside the folders."""
    parts = path.relative_to(ROOT).parts
    return parts[0] if len(parts) > 1 else "top"


def count_lines() -> dict[str, int]:
    """Count the lines of each package."""
    sizes: dict[str, int] = {}
    for path in ROOT.rglob("*.py"):
        name = name_package(path)
        sizes[name] = sizes.get(name, 0) + len(path.read_text(encoding="utf-8").splitlines())

    return sizes


def draw(
    package: str, count: int, generator: random.Random, kinds: dict[str, Any]
) -> list[dict[str, Any]]:
    """Draw the mutants of a package: a file by its lines, a line of
    it that can change, and a change there.
    """
    paths = sorted(path for path in ROOT.rglob("*.py") if name_package(path) == package)
    weights = [len(path.read_text(encoding="utf-8").splitlines()) for path in paths]
    found: dict[tuple[str, str, int], dict[str, Any]] = {}

    for _ in range(50 * count):
        if len(found) == count:
            break

        path = generator.choices(paths, weights)[0]
        source = path.read_text(encoding="utf-8")
        number = generator.randint(1, len(source.splitlines()))
        places = list_places(source, kinds).get(number, [])

        if places:
            name, occurrence = generator.choice(places)
            key = (str(path), name, occurrence)
            if key not in found and (
                mutant := change(
                    path,
                    source=source,
                    name=name,
                    occurrence=occurrence,
                    kinds=kinds,
                )
            ):
                found[key] = mutant | {"package": package}

    return list(found.values())


_places: dict[int, dict[int, list[tuple[str, int]]]] = {}


def list_places(source: str, kinds: dict[str, Any]) -> dict[int, list[tuple[str, int]]]:
    """List the changes that begin on each line: name of the
    operator, and its occurrence in the file.
    """
    from cosmic_ray.ast import ast_nodes, get_ast

    if hash(source) not in _places:
        by_line: dict[int, list[tuple[str, int]]] = {}
        nodes = list(ast_nodes(get_ast(source)))
        for name, kind in kinds.items():
            places = [place for node in nodes for place in kind().mutation_positions(node)]
            for occurrence, (begin, _) in enumerate(places):
                by_line.setdefault(begin[0], []).append((name, occurrence))

        _places[hash(source)] = by_line

    return _places[hash(source)]


def change(
    path: Path,
    source: str,
    name: str,
    occurrence: int,
    kinds: dict[str, Any],
) -> dict[str, Any] | None:
    """Change a source; None if it stays as it is."""
    from cosmic_ray.mutating import mutate_code

    try:
        code = mutate_code(source, kinds[name](), occurrence)
        # 1e300 and 1e+300 are one number.
        if code is None or ast.dump(ast.parse(code)) == ast.dump(ast.parse(source)):
            return None
    except (
        SyntaxError,
        AttributeError,
    ):  # an operator without its operand, an exception of another module
        return None

    # Where a line goes, cosmic-ray takes the blank lines before it too.
    old = list_lines(source)
    new = list_lines(code)
    place = next((i for i, pair in enumerate(zip(old, new)) if pair[0][1] != pair[1][1]), 0)  # noqa: B905
    number, before = old[place]
    after = new[place][1] if len(new) == len(old) else ""

    return {
        "path": str(path.relative_to(ROOT.parents[1])),
        "line": number,
        "operator": name.removeprefix("core/"),
        "before": before,
        "after": after,
        "code": code,
    }


def list_lines(code: str) -> list[tuple[int, str]]:
    """List the lines that are not blank, with their numbers from 1, without indentation."""
    return [(i + 1, line.strip()) for i, line in enumerate(code.splitlines()) if line.strip()]


if __name__ == "__main__":
    main()
