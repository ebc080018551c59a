"""Command `python -m benchmarks.slip`: slip detectors by delay and
false alarms, on recordings or computed signals.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from benchmarks.command import answer
from benchmarks.slip.run import DEFAULT_SHARE, FILES, read_options, run
from fingertip.cli.console import Console
from fingertip.cli.options import load_design
from fingertip.foundation.output_set import SetWriter, hash_parameters


def main(words: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.slip", description=__doc__)
    parser.add_argument(
        "recordings",
        nargs="?",
        type=Path,
        help="folder of a public set, or of recordings with a file labels.csv beside them (lines "
        "such as "
        "a.csv,slip,1.2,1.9, with the header file,kind,start_s,end_s); default: the project's own "
        "signals",
    )
    parser.add_argument(
        "--layout", help="layout of a public set, as its authors publish it; `list` names them"
    )
    parser.add_argument(
        "--design", type=Path, help="design file or bundled name; default: the default design"
    )
    parser.add_argument(
        "--detectors",
        help="comma-separated: fast, incipient, digital (the article's chain), fft (the stronger "
        "one), plain_fft (as "
        "published), cusum, ratio (of energies); default: all",
    )
    parser.add_argument(
        "--own",
        type=Path,
        help="Python file with a detector of yours: find_statistic and THRESHOLD",
    )
    parser.add_argument(
        "--share",
        type=float,
        default=DEFAULT_SHARE,
        help="share of the project's own signals, 0.05 to 1, that each of five seeds draws",
    )
    parser.add_argument(
        "--out",
        "-o",
        type=Path,
        default=Path("out/bench_slip"),
        help=f"folder for {', '.join(FILES)}",
    )
    answer(parser, _run, words)


def _run(options: argparse.Namespace, console: Console) -> None:
    design = load_design(options.design, None)
    chosen = read_options(
        options.recordings,
        layout=options.layout,
        detectors=options.detectors,
        own=options.own,
        share=options.share,
    )
    writer = SetWriter(options.out, "slip benchmark", "", hash_parameters([]))
    writer.check(FILES)
    report = run(design, chosen, console.progress, console.warn)
    writer.write(dict(zip(FILES, report.encode(), strict=True)))
    console.result(
        report.as_data(), f"{report.as_text()}\nwrote {', '.join(FILES)} to {options.out}"
    )


if __name__ == "__main__":
    main()
