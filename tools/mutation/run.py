"""Command `python -m tools.mutation.run`: change the source in one place at a time, and list what
no test notices.

    python -m tools.mutation.reach -n 2    once: which tests enter which blocks
    python -m tools.mutation.run --cosmic-ray PYTHON --seed 2026 --jobs 1

The mutants are drawn over all lines of src (`tools/mutation/changes.py`). The first set of tests
judges each, then the rest of the suite, as far as it was recorded (`reach` with FINGERTIP_FULL=1:
an hour). A command that is stopped goes on where it was: out/mutation has the results. The exit
code is 1 if less than `MIN_KILLED` of all mutants, or `MIN_KILLED_GROUP` of those of a group of
packages, were noticed, or less than `MIN_KILLED_FIRST` by the first set.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import sys
import time
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import pytest

from tools.mutation.mutants import ROOT, Mutant, Reach, draw_mutants
from tools.mutation.server import Job, Outcome, Server

RESULTS = ROOT / "out" / "mutation"
MIN_KILLED = 0.85
MIN_KILLED_GROUP = 0.75
MIN_KILLED_FIRST = 0.8
GROUP = 40
"""Shares that the tests must notice, and the number of mutants
that a group of packages has at least.
"""
NOT = "not noticed"
FIRST = "first set"
REST = "whole suite"
"""Judgements of a mutant."""


def main() -> None:
    """Run the mutants and report."""
    parser = argparse.ArgumentParser(description="Mutation testing of src.")
    parser.add_argument("packages", nargs="*", help="folders of src/fingertip; all by default")
    parser.add_argument("--cosmic-ray", default=sys.executable, help="Python that has cosmic-ray")
    parser.add_argument("--count", type=int, default=40, help="number of mutants")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draw")
    parser.add_argument(
        "--cpu-s",
        type=float,
        default=60.0,
        help="CPU time of the first set, and of the others, for one mutant [s]",
    )
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="number of mutants at once"
    )
    options = parser.parse_args()
    os.environ.setdefault("FINGERTIP_FULL", "1")  # empty: the first set alone judges
    mutants = draw_mutants(options.cosmic_ray, options.count, options.seed, options.packages)
    file = RESULTS / f"{options.seed}.json"
    known: dict[str, list[str]] = json.loads(file.read_text("utf-8")) if file.exists() else {}
    todo = [mutant for mutant in mutants if known.get(key_of(mutant), [NOT])[0] == NOT]
    random.Random(options.seed).shuffle(todo)  # what a stopped command has done is a sample too
    begun_s = time.monotonic()
    done = 0
    reach = Reach.read()
    first: Collection[str] = ()

    def make(in_first: Collection[str], kills: Counter[str]) -> Iterator[Job]:
        nonlocal first
        first = in_first
        for mutant in todo:
            yield plan_job(
                mutant,
                reach=reach,
                first=first,
                kills=kills,
                cpu_s=options.cpu_s,
            )

    def report(job: Job, outcome: Outcome) -> None:
        nonlocal done
        is_first = all(test in first for test in ([outcome.test] if outcome.test else job.tests))
        if not outcome.noticed:
            by = NOT
        elif is_first:
            by = FIRST
        else:
            by = REST

        known[key_of(job.mutant)] = [by, outcome.test or "a limit or a fault of the process"]
        file.write_text(json.dumps(known, indent=1), "utf-8")
        done += 1
        left_s = (time.monotonic() - begun_s) / done * (len(todo) - done)
        print(f"{done} of {len(todo)}, {left_s / 60:.0f} min left: {by}", flush=True)

    if todo:
        RESULTS.mkdir(parents=True, exist_ok=True)
        words = [
            "-q",
            "-s",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:randomly",
            "--tb=no",
            "-o",
            "addopts=",
        ]
        os.chdir(ROOT)
        pytest.main(words, plugins=[Server(make, report, options.jobs)])

    sys.exit(print_scores([(mutant, known.get(key_of(mutant), [NOT])[0]) for mutant in mutants]))


def key_of(mutant: Mutant) -> str:
    """Return the key under which the result of a mutant is kept."""
    return hashlib.sha256(f"{mutant.path}\n{mutant.code}".encode()).hexdigest()


def plan_job(
    mutant: Mutant,
    reach: Reach,
    first: Collection[str],
    kills: Counter[str],
    cpu_s: float,
) -> Job:
    """Select the tests of a mutant: the first set, then the others, each as far as time allows.

    Those that noticed most come first, then the cheapest.
    """
    words = set(Path(mutant.path).stem.split("_")) | {mutant.package}

    def rank(test: str) -> tuple[bool, int, bool, float]:
        is_elsewhere = words.isdisjoint(test.partition("::")[0].replace("/", "_").split("_"))
        return test not in first, -kills[test], is_elsewhere, reach.cost_s[test]

    chosen = []
    fixtures = set[str]()
    spent_s = {True: 0.0, False: 0.0}

    for test in sorted(reach.candidates(mutant), key=rank):
        new = set(reach.fixtures[test]) - fixtures
        cost_s = reach.cost_s[test] + sum(reach.fixture_cost_s.get(one, 0.0) for one in new)
        if spent_s[test in first] + cost_s <= cpu_s:
            chosen.append(test)
            fixtures |= new
            spent_s[test in first] += cost_s

    return Job(mutant, chosen, sum(spent_s.values()), is_fresh=not reach.is_in_function(mutant))


def print_scores(results: Sequence[tuple[Mutant, str]]) -> int:
    """Print survivors and scores with 95 % intervals, and return the exit status."""
    for mutant, by in results:
        if by == NOT:
            print(mutant)

    status = 0
    for names in group_packages(Counter(mutant.package for mutant, _ in results)):
        of_group = [by for mutant, by in results if mutant.package in names]
        status |= print_score(", ".join(names), [by != NOT for by in of_group], MIN_KILLED_GROUP)

    status |= print_score(
        "all, by the first set", [by == FIRST for _, by in results], MIN_KILLED_FIRST
    )
    return status | print_score("all", [by != NOT for _, by in results], MIN_KILLED)


def group_packages(counts: Counter[str]) -> list[list[str]]:
    """Group packages by name until each group has enough mutants; a large package stands alone."""
    groups: list[list[str]] = [[name] for name in sorted(counts) if counts[name] >= GROUP]
    pooled: list[list[str]] = [[]]

    for name in sorted(set(counts) - {name for (name,) in groups}):
        if sum(counts[one] for one in pooled[-1]) >= GROUP:
            pooled.append([])

        pooled[-1].append(name)

    if len(pooled) > 1 and sum(counts[one] for one in pooled[-1]) < GROUP:
        last = pooled.pop()
        pooled[-1] += last

    return groups + [names for names in pooled if names]


def print_score(name: str, noticed: Sequence[bool], wanted: float) -> int:
    """Print one score, and return 1 if it is below what is wanted."""
    from scipy.stats import binomtest

    count = len(noticed)
    killed = sum(noticed)
    if not count:
        return 0

    interval = binomtest(killed, count).proportion_ci(method="wilson")
    verdict = "" if killed >= wanted * count else f"   BELOW {wanted:.0%}"
    print(
        f"{killed / count:6.1%} [{interval.low:.1%}, {interval.high:.1%}] of {count:4} noticed: "
        f"{name}{verdict}"
    )
    return int(bool(verdict))


if __name__ == "__main__":
    main()
