"""Parameters of the CadQuery scripts beside this file: their bounds, and what is refused.

Scripts of `fingertip build --formats cq` carry this module with the bounds of a design.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

BOUNDS: dict[str, tuple[float, float, float]] = {}
"""Lower bound, value in the design, and upper bound of each parameter, by its name in the design file."""


def settle(names: dict[str, Any]) -> Callable[[bool, str], None]:
    """Take CHANGES, keep parameters within their bounds, and return what refuses those that need other statements."""
    paths = {path.replace(".", "_").removeprefix("custom_"): path for path in BOUNDS}
    refusal = names.get("REFUSAL") or (SystemExit if names.get("__name__") == "__main__" else ValueError)
    changes = names.get("CHANGES", {})
    wrong = [f"CHANGES: there is no parameter {name}" for name in changes if name not in paths]
    names |= {name: value for name, value in changes.items() if name in names}
    values = {name: names[name] for name in paths if name in names}
    wrong += [f"{name} = {value} is not within {low} to {high}" for name, value in values.items()
              if not (low := BOUNDS[paths[name]][0]) <= value <= (high := BOUNDS[paths[name]][2])]  # fmt: skip
    if wrong:
        raise refusal("\n".join(wrong))

    def require(holds: bool, condition: str) -> None:
        if not holds:
            changed = [name for name, value in values.items() if value != BOUNDS[paths[name]][1]]
            is_bought = any(paths[name].startswith("custom_") for name in changed)
            sets = [f"--set {paths[name]}={value}" for name, value in values.items()
                    if name in changed or (is_bought and paths[name].startswith("custom_"))]  # fmt: skip
            remedy = " ".join(["design.toml --formats cq", *["--set sensor.model=custom"] * is_bought, *sets])
            said = f"{', '.join(changed)}: {condition} does not hold; write a new script"
            raise refusal(f"{said}: fingertip build {remedy}")

    return require
