"""Command `python -m tools.fuzz.guided`: try the targets with cases that reach new branches, by atheris.

    pip install atheris
    python -m tools.fuzz.guided --seconds 60 --out out/fuzz/guided

Bytes that reach new branches are kept in the folder of each target, where the next run begins with them. Exit code 1:
there is a fault, whose bytes stand beside these folders.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["fingertip"], enable_loader_override=False):
    from tools.fuzz.targets import TARGETS, list_examples, run_each


def run_guided(name: str, seconds: float, first_seed: int, out: Path) -> None:
    """Try a target for a while, and end this process."""
    corpus = out / name
    corpus.mkdir(parents=True, exist_ok=True)
    for i, data in enumerate(list_examples(name)):
        (corpus / f"valid-{i}").write_bytes(data)
    options = (
        f"max_total_time={seconds:.0f}",
        f"seed={first_seed + 1}",
        "timeout=20",
        f"artifact_prefix={out}/{name}-",
    )
    atheris.Setup([sys.argv[0], *(f"-{option}" for option in options), str(corpus)], TARGETS[name])
    atheris.Fuzz()


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--targets", default=",".join(TARGETS))
    parser.add_argument("--seconds", type=float, default=60.0, help="time for each target")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("out/fuzz/guided"))
    options = parser.parse_args()

    def run(name: str) -> None:
        run_guided(name, options.seconds, options.seed, options.out)

    return run_each(run, options.targets.split(","))


if __name__ == "__main__":
    raise SystemExit(main())
