"""Parameters of the CadQuery scripts beside this file: their bounds, and what is refused, by the
kernel too.

Scripts of `fingertip build --formats cq` carry this module with the bounds of a design.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

BOUNDS: dict[str, tuple[float, float, float]] = {}
"""Lower bound, value in the design, and upper bound of each
parameter, by its name in the design file.
"""


def settle(names: dict[str, Any]) -> Callable[[bool, str], None]:
    """Take CHANGES, keep parameters within their bounds, and return
    what refuses those that need other statements.
    """
    paths = {path.replace(".", "_").removeprefix("custom_"): path for path in BOUNDS}
    refusal = names.get("REFUSAL") or (
        SystemExit if names.get("__name__") == "__main__" else ValueError
    )
    changes = names.get("CHANGES", {})
    wrong = [f"CHANGES: there is no parameter {name}" for name in changes if name not in paths]
    names |= {name: value for name, value in changes.items() if name in names}
    values = {name: names[name] for name in paths if name in names}

    for name, value in values.items():
        low, _, high = BOUNDS[paths[name]]
        if not (isinstance(value, float | int) and low <= value <= high):
            wrong.append(f"{name} = {value!r} is no number within {low} to {high}")

    if wrong:
        raise refusal("\n".join(wrong))

    changed = {name: value for name, value in values.items() if value != BOUNDS[paths[name]][1]}
    is_bought = any(paths[name].startswith("custom_") for name in changed)

    def refuse(problem: str) -> BaseException:
        sets = [
            f"--set {paths[name]}={value}"
            for name, value in values.items()
            if name in changed or (is_bought and paths[name].startswith("custom_"))
        ]
        remedy = " ".join(
            ["design.toml --formats cq", *["--set sensor.model=custom"] * is_bought, *sets]
        )
        said = ", ".join(f"{name} = {value}" for name, value in changed.items())
        return refusal(f"{said}: {problem}: fingertip build {remedy}")

    @contextmanager
    def guard(name: str) -> Iterator[None]:
        try:
            yield
        except Exception as error:
            raise refuse(f"{name} has no result; a build says which rule this breaks") from error

    def require(holds: bool, condition: str) -> None:
        if not holds:
            raise refuse(
                f"this script is for a part whose {condition.replace('!=', 'is not')}; write it "
                "anew"
            )

    names |= {
        name: guard(name)(each)
        for name, each in names.items()
        if changed and str(getattr(each, "__module__", "")).startswith("cq_")
    }
    return require
