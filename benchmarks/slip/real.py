"""The fair bench: detectors on real grasps, slides and blows, and on signals of the project's own.

    python -m benchmarks.slip.real FOLDER [--tuning] [--detectors fast digital] [--curve] [--record]

The folder holds four public sets, which you download (`real_sets` and `docs/slip_benchmark.md` name
them); each is divided by file. A detector that is told the noise takes it from the rest right
before a slide, or from the begin of a grasp: in one row from 0.3 s, in the other from 4 s. On the
project's own signals the design states the noise. `--curve` runs several thresholds of each
detector. `--record` writes what the package says of a detection's worth.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.slip import goals, record
from benchmarks.slip.bench import Found, Results, Source, list_factors, measure, select
from benchmarks.slip.competitors import COMPETITORS, Row, list_rows
from benchmarks.slip.curve import CurvePoint, Panel, draw, make_point
from benchmarks.slip.own_sets import (
    JUDGING,
    LINES,
    LOAD_LAWS,
    SHARE,
    TRIAL_DESIGNS,
    TRIALS,
    TUNING,
    list_own,
    name_trials,
)
from benchmarks.slip.real_sets import SLIDES, STRENGTHS, RealSet, list_real
from benchmarks.slip.report import delays
from benchmarks.slip.scores import Tally, share_interval
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.workers import count_processors, side_by_side

HASHES = {
    (JUDGING, "grasps"): "4b712e0776a5c1ff840bc00f1b5bb0be86cd333482f4baf4ec71b5188b03e263",
    (JUDGING, "slides"): "088e3b1b541a0ba5ddcebe8ca43e2d643e61351315f7801d4109d9ca7cc64a8f",
    (JUDGING, "hits"): "3bfef9f3dc8acbbb889e0eac16fef53af56d9e2187ab8f3c31ce7cd6dcbed51d",
    (JUDGING, "stage"): "38083f173ecfc7bc98fd96e48451f8c27cf49dd32989ff63daedc2d7e0785248",
    (TUNING, "grasps"): "b644732d2c85e0999fee3049b40a80fb34e5ada1800aec7cc70fee9f1d5e77f6",
    (TUNING, "slides"): "9933543b52842cd097d4b5688898f6d26fbc60af7fb0ff80afcf06dd6a670a2a",
    (TUNING, "hits"): "bf7a5c008252f782e6ce0e1ade835ff804d4cb0ab6953e8b7ca1bd266bfca61d",
}
"""SHA-256 of the files that each half of a set uses, in the order of their names."""
OTHER_HALF = -1
"""Number of the run in which the grasps of the other half are judged."""
FILES = ("slip_real.md", "slip_real.json", "slip_curve.svg")


@dataclass(frozen=True, eq=False)
class FairReport:
    """What each detector reached, and on which files."""

    found: Found
    rows: Sequence[Row]
    files: dict[str, dict[str, Any]]

    def as_data(self) -> dict[str, Any]:
        """Convert it to plain mappings and lists for JSON. Keys contain their units."""
        data: dict[str, Any] = {"files": self.files, "rows": []}
        for row in self.rows:
            results = self._own(row)
            kinds = sorted({kind for kind, _ in results.by_kind})
            found = {kind: results.of(kind).as_data() for kind in kinds}
            curves = {
                mix: [one.as_data() for one in _list_points(self.found, row, mix)] for mix in MIXES
            }
            data["rows"].append(
                {
                    "detector": row.name,
                    "rest_s": row.rest_s,
                    "label": row.label,
                    "kinds": found,
                    "lines": self._describe_lines(row),
                    "own_slips": results.of(*_slip_rows(results)).as_data(),
                    "null_test": results.of("grasp", *LINES["quiet"]).as_data(),
                    "curves": curves,
                }
            )

        data["goals"] = [goal.as_data() for goal in self.goals()]
        return data

    def as_text(self) -> str:
        """Write the tables, in Markdown."""
        parts = [
            *(_describe_files(name, one) for name, one in self.files.items()),
            "",
            *self._table(REAL_COLUMNS, self._real_cells),
            "",
            *self._table(OWN_COLUMNS, self._own_cells),
            "",
            *self._curve_table(),
        ]
        goals_found = [goal.describe() for goal in self.goals()]
        if goals_found:
            parts += ["", "| must reach | goal | reached | met |", "| --- " * 4 + "|", *goals_found]

        return "\n".join(parts)

    def goals(self) -> list[goals.Goal]:
        """List the goals, if both flags of `fast` were run on everything."""
        both = [self._own(Row(name)) for name in ("fast", "incipient")]
        last = name_trials(TRIAL_DESIGNS[-1], LOAD_LAWS[-1])
        needed = [part for one in both for part in (one.of("stage"), one.of(last), one.of("tap"))]
        is_whole = all(part.slips or part.events for part in needed)
        return list(goals.list_goals(*both)) if is_whole else []

    def draw(self) -> bytes:
        names = {"real slides": "real", "own signals": "own"}
        panels = [
            Panel(title, 0.9, {row: _list_points(self.found, row, mix) for row in self.rows})
            for title, mix in names.items()
        ]
        return draw(panels, 0.01)

    def _own(self, row: Row) -> Results:
        """What a detector reached; the rows of a baseline share the project's own signals."""
        twin = select(self.found, replace(row, rest_s=min(row.rest_s, SHORT_S)))
        return Results({**twin.by_kind, **select(self.found, row).by_kind})

    def _table(self, columns: Sequence[str], make_cells: Any) -> Iterator[str]:
        yield f"| {' | '.join(columns)} |"
        yield "| --- " * len(columns) + "|"
        for row in self.rows:
            yield f"| {' | '.join([row.label, *make_cells(row)])} |"

    def _real_cells(self, row: Row) -> Iterator[str]:
        results = self._own(row)
        yield describe_slips(results.of("stage"))
        yield from (describe_slips(results.of(kind)) for kind in SLIDES)
        yield describe_events(results.of("stick hit"))
        grasps = results.of("grasp", run=0)
        yield f"{grasps.counted} in {grasps.minutes:.1f} min"
        yield f"{results.of('grasp', run=OTHER_HALF).counted}"
        yield f"{results.of(*SLIDES).counted}"
        quiet = results.of("grasp", *LINES["quiet"])
        minutes = quiet.windows * FOUND_MINUTES
        yield f"{quiet.found_windows} of {quiet.windows}, {minutes:.0f} min"

    def _own_cells(self, row: Row) -> Iterator[str]:
        results = self._own(row)
        for line, counts in self._count_lines(row).items():
            if line in BLOWS:
                yield describe_events(results.of(*LINES[line]))
            elif counts:
                yield f"{sum(counts) / len(counts):.1f} ({min(counts)} to {max(counts)})"
            else:
                yield "-"

        slips = results.of(*_slip_rows(results))
        yield describe_slips(slips)
        yield describe_slips(results.of(goals.BURST))
        for law in LOAD_LAWS:
            yield describe_slips(
                results.of(*(name_trials(design, law) for design in TRIAL_DESIGNS))
            )

    def _count_lines(self, row: Row) -> dict[str, list[int]]:
        """Count the alarms of each line of the project's own signals, by seed."""
        results = self._own(row)
        runs = goals.list_runs(results)
        return {
            line: [results.of(*kinds, run=run).counted for run in runs]
            for line, kinds in LINES.items()
        }

    def _describe_lines(self, row: Row) -> dict[str, dict[str, Any]]:
        """Describe each line of the project's own signals, with its alarms by seed."""
        results = self._own(row)
        return {
            line: {"alarms_by_seed": counts, **results.of(*LINES[line]).as_data()}
            for line, counts in self._count_lines(row).items()
        }

    def _curve_table(self) -> Iterator[str]:
        yield "| detector | threshold | real: alarms/min | delay | own: alarms/min | delay |"
        yield "| --- " * 6 + "|"
        for row in self.rows:
            pairs = zip(*(_list_points(self.found, row, mix) for mix in MIXES), strict=True)
            for real, own in pairs:
                cells = [f"x {real.factor:g}"]
                for point in (real, own):
                    cells += [
                        f"{point.alarms_per_minute:.2f}",
                        delays(point.median_ms, point.p90_ms),
                    ]

                yield f"| {' | '.join([row.label, *cells])} |"


SHORT_S = 0.3
PARTS = 12
FOUND_MINUTES = 0.2 / 60
BLOWS = ("taps", "knocks", "rings")
MIXES = ("real", "own")
REAL_COLUMNS = (
    "detector",
    "stage",
    *STRENGTHS,
    "stick hits",
    "grasps: alarms",
    "of the other half",
    "before and in slides",
    "null test",
)
OWN_COLUMNS = (
    "detector",
    *LINES,
    "slips",
    "bursts above 60 Hz",
    *(f"trials, {law}" for law in LOAD_LAWS),
)


def _slip_rows(results: Results) -> list[str]:
    """List the rows of the generators that hold slips."""
    lines = {kind for kinds in LINES.values() for kind in kinds}
    others = ("stage", "grasp", "stick hit", *SLIDES)
    return [
        kind
        for kind in dict.fromkeys(kind for kind, _ in results.by_kind)
        if kind not in lines | set(others) and not kind.startswith(("burst", "trials"))
    ]


def _list_points(found: Found, row: Row, mix: str) -> list[CurvePoint]:
    """List the points of a curve: slides against grasps and hits, or own slips against all else."""
    points = []
    for factor in list_factors(found, row):
        results = select(found, row, factor)
        if mix == "real":
            slips = results.of(*SLIDES)
            quiet = results.of("grasp", "stick hit")
        else:
            twin = select(found, replace(row, rest_s=min(row.rest_s, SHORT_S)), factor)
            slips = twin.of(*_slip_rows(twin))
            quiet = twin.of(*(kind for kinds in LINES.values() for kind in kinds))

        points.append(make_point(factor, slips, quiet))

    return points


def describe_slips(tally: Tally) -> str:
    """Describe delays and share ON, with the interval of the share that was found."""
    if not tally.slips:
        return "-"

    found = len(tally.delays_s)
    low, high = share_interval(found, tally.slips)
    both = delays(tally.quantile_ms(0.5), tally.quantile_ms(0.9))
    percent = f"[{100 * low:.0f}, {100 * high:.0f}] %"
    return f"{found} of {tally.slips} {percent}, {both} ms, {tally.on_share:.3f}"


def describe_events(tally: Tally) -> str:
    if not tally.events:
        return "-"

    low, high = share_interval(tally.taken, tally.events)
    percent = f"[{100 * low:.0f}, {100 * high:.0f}] %"
    return f"{tally.taken} of {tally.events} {percent}"


def _describe_files(name: str, one: dict[str, Any]) -> str:
    stated = "as stated" if one["is_stated"] else "NOT as stated: other files, other numbers"
    return f"{name}: {one['files']} files, sha256 {one['sha256']}, {stated}."


def hash_sets(sets: Sequence[RealSet]) -> dict[str, dict[str, Any]]:
    """Hash the files that were read, and compare them with those that gave the stated numbers."""
    hashed = {}
    for one in sets:
        count, sha256 = one.hash()
        is_stated = HASHES.get((one.half, one.name)) == sha256
        hashed[f"{one.name}, {one.half}"] = {
            "files": count,
            "sha256": sha256,
            "is_stated": is_stated,
        }

    return hashed


def list_sources(
    sets: Sequence[RealSet], half: str, share: float, trials_each: int = TRIALS
) -> list[Source]:
    """List all that is judged: real sets, grasps of the other half, and own signals."""
    other = TUNING if half == JUDGING else JUDGING
    more = [replace(one, half=other, run=OTHER_HALF) for one in sets if one.name == "grasps"]
    own = list_own(half, share, trials_each) if share else []
    parts = [part for one in [*sets, *more] for part in one.divide(PARTS)]
    return [*parts, *own]


def main(words: Sequence[str] | None = None) -> None:
    """Print the tables, and write them with the curves if a folder is given."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--tuning", action="store_true", help="take the half for tuning, not the one that judges"
    )
    parser.add_argument(
        "--detectors",
        nargs="+",
        default=list(COMPETITORS),
        help=f"of {', '.join(COMPETITORS)}, or the file of another table of fast",
    )
    parser.add_argument(
        "--share",
        type=float,
        default=SHARE,
        help="share of the project's own signals that each seed draws; 0: none",
    )
    parser.add_argument(
        "--trials", type=int, default=TRIALS, help="simulated trials of each design; 0: none"
    )
    parser.add_argument("--curve", action="store_true", help="run several thresholds")
    parser.add_argument("--record", action="store_true", help=f"write {record.FILE.name}")
    parser.add_argument("--json", action="store_true", help="print data in place of the tables")
    parser.add_argument("--out", "-o", type=Path, help=f"folder for {', '.join(FILES)}")
    options = parser.parse_args(words)

    try:
        _run(options)
    except (FingertipError, OSError) as error:
        sys.exit(str(error))


def _run(options: argparse.Namespace) -> None:
    half = TUNING if options.tuning else JUDGING
    sets = list_real(options.folder, half)
    files = hash_sets(sets)
    if options.record:
        card = {"half": half, "files": files}
        record.write_record(record.make_record(sets, card))
        print(f"wrote {record.FILE}")
        return

    rows = list_rows(options.detectors)
    factors = None if options.curve else (1.0,)
    with side_by_side(count_processors()):
        sources = list_sources(sets, half, options.share, options.trials)
        found = measure(Design.load("article"), rows, sources, factors)

    report = FairReport(found, rows, files)
    data = json.dumps(report.as_data(), indent=1, allow_nan=False)
    print(data if options.json else report.as_text())
    if options.out:
        contents = (report.as_text().encode(), data.encode(), report.draw())
        options.out.mkdir(parents=True, exist_ok=True)
        for name, content in zip(FILES, contents, strict=True):
            (options.out / name).write_bytes(content)


if __name__ == "__main__":
    main()
