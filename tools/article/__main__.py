"""Command `python -m tools.article`: the studies of the article.

    python -m tools.article
    python -m tools.article --figures
    python -m tools.article DESIGN --figures [--out FOLDER]
    python -m tools.article DESIGN [--trials 120] [--minutes 40] [--detector fast] [--jobs 2]
        [--out FOLDER]

Without a design it measures `tools/article/beside_article.json` and writes `docs/beside_article.md`
from it, which takes some minutes: run it again after a change of simulation or detectors. With one
it makes all studies of it. With `--figures` it draws the article's figures alone, from trials of
the design's finger on the article's board.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

from fingertip.design import Design
from fingertip.foundation.workers import find_workers, side_by_side
from fingertip.lab.campaign.campaign import CampaignPlan
from tools.article.page import write_figures, write_page
from tools.article.pictures.collect import as_files, draw_figures
from tools.article.studies import study


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("design", nargs="?")
    parser.add_argument("--trials", type=int, default=120)
    parser.add_argument("--minutes", type=float, default=40.0)
    parser.add_argument("--detector", default="fast")
    parser.add_argument("--jobs", type=int, help="processes; default: one for each processor")
    parser.add_argument("--out", type=Path, help="folder; default: out/NAME/studies or figures")
    parser.add_argument("--figures", action="store_true", help="draw the article's figures alone")
    arguments = parser.parse_args()

    if arguments.design is None:
        write_figures() if arguments.figures else write_page()
        return

    design = Design.load(arguments.design)
    if arguments.figures:
        folder = arguments.out or Path("out") / design.name / "figures"
        _write(folder, as_files(draw_figures(design)))
        print(folder / "figures.md")
        return

    plan = CampaignPlan(arguments.trials, arguments.minutes)
    if not design.board.has_filter:
        sys.exit(
            f"{design.name}: its board has no filter, which the studies are about; choose a "
            "design that has one."
        )

    with side_by_side(find_workers(arguments.jobs)):
        files = study(
            design, plan, arguments.detector, lambda text: print(text, file=sys.stderr)
        ).files()

    _write(arguments.out or Path("out") / design.name / "studies", files)
    print(files["studies.txt"].decode(), end="")


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
