"""Command `python tools/mutation/changes.py MODULE`: print every mutant of a module as a line of JSON.

Run it with a Python that has cosmic-ray; it needs nothing of this repository.
"""

import json
import re
import sys
from pathlib import Path

LEFT_OUT = (
    r"core/ReplaceBinaryOperator_.*_(Mod|FloorDiv|Pow|RShift|LShift|BitAnd|BitOr|BitXor)",  # nobody mistypes so
    r"core/ReplaceBinaryOperator_BitOr_.*",  # of annotations, which cannot fail
    r"core/ReplaceComparisonOperator_.*_Is.*",  # identity of small numbers is equality
    r"core/ReplaceTrueWithFalse",  # strict=True is no behaviour
)


def main() -> None:
    """Print the mutants in the order of their places."""
    # mypy sees no cosmic-ray here: it is in another environment.
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator, operator_names

    source = Path(sys.argv[1]).read_text(encoding="utf-8")
    tree, found = get_ast(source), []
    for name in operator_names():
        kind = get_operator(name)
        if kind.arguments() or any(re.fullmatch(one, name) for one in LEFT_OUT):
            continue
        places = [place for node in ast_nodes(tree) for place in kind().mutation_positions(node)]
        for occurrence, (start, _) in enumerate(places):
            changed = mutate_code(source, kind(), occurrence)
            if changed is not None and changed != source:
                found.append((start, name, occurrence, changed))
    for start, name, _, changed in sorted(found):
        # Where a line goes, cosmic-ray takes the blank lines before it too.
        old, new = list_lines(source), list_lines(changed)
        place = next((i for i, pair in enumerate(zip(old, new)) if pair[0][1] != pair[1][1]), 0)  # noqa: B905
        number, before = old[place]
        mutant = {
            "line": number, "operator": name.removeprefix("core/"), "before": before,
            "after": new[place][1] if len(new) == len(old) else "", "code": changed, "column": start[1],
        }  # fmt: skip
        print(json.dumps(mutant))


def list_lines(code: str) -> list[tuple[int, str]]:
    """List the lines that are not blank, with their numbers from 1, without indentation."""
    return [(i + 1, line.strip()) for i, line in enumerate(code.splitlines()) if line.strip()]


if __name__ == "__main__":
    main()
