"""Command `fingertip compare`: what a change of a design changes, for the person who reviews it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from fingertip.cli.console import Console, align_columns
from fingertip.cli.options import command, load_design, parse_design
from fingertip.foundation.errors import DesignError, Issue, gather, raise_issues
from fingertip.foundation.input_files import is_safe_name

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.documents.comparison import Comparison, Version
    from fingertip.foundation.output_set import SetWriter

_PAGE = "comparison.md"
_PICTURE = "comparison.png"


@command
def compare(
    console: Console,
    old: Path = typer.Argument(
        parser=parse_design, help="Design, folder that make or build wrote, or git revision of NEW."
    ),
    new: Path = typer.Argument(
        parser=parse_design, help="Design, or folder that make or build wrote."
    ),
    out: Path | None = typer.Option(
        None, metavar="PATH", help=f"Folder for {_PAGE} and a picture of both."
    ),
    force: bool = typer.Option(
        False, "--force", help="Overwrite files there that fingertip did not write."
    ),
) -> None:
    """Show what differs between two versions of a finger: parameters, mass, price, share of the
    force, delay, checks.

    A design is built in a temporary folder, which takes about ten seconds; a folder is read as it
    is. OLD may be a revision of git, such as main or HEAD~1, in which the design file NEW is read.
    The exit code is 0 whatever differs.
    """
    from fingertip.documents.comparison import compare_versions

    before, after = _load_sides(old, new)
    writer = _plan_output(out, new, force) if out else None

    versions = [_read(side, console) for side in (before, after)]
    comparison = compare_versions(*versions)

    text = format_comparison(comparison)

    if writer:
        writer.write(_make_files(comparison, versions))
        text += f"\n\nlook at: {writer.folder / _PAGE}"

    console.result(comparison.to_dict(), text)


@dataclass(frozen=True)
class _Side:
    """One of the two compared versions: as read, or a design that is made first."""

    label: str
    version: Version | Design


def _load_sides(old: Path, new: Path) -> tuple[_Side, _Side]:
    """Load both sides, and raise all that is wrong with either."""
    issues: list[Issue] = []
    sides: list[_Side] = []
    with gather(issues, prefix="OLD: "):
        sides.append(_load_old(old, new))

    with gather(issues, prefix="NEW: "):
        sides.append(_load_side(new))

    raise_issues(DesignError, issues)
    before, after = sides
    return before, after


def _load_old(old: Path, new: Path) -> _Side:
    from fingertip.catalogues.file_kinds import DESIGN, SET, is_bundled_name

    if old.exists() or old.suffix == ".toml" or is_bundled_name(old, DESIGN, SET):
        return _load_side(old)

    if not new.is_file():
        message = (
            "is no design and no folder; to read it as a git revision, NEW must be a "
            f"design file, and {new} is none."
        )
        raise DesignError(Issue(str(old), message))

    return _Side(f"{new} at {old.as_posix()}", _load_revision(old.as_posix(), new))


def _load_side(path: Path) -> _Side:
    from fingertip.catalogues.file_kinds import DESIGN, SET, is_bundled_name
    from fingertip.design.finger_set import is_set
    from fingertip.tasks.versions import read_version

    if path.is_dir() and not is_bundled_name(path, DESIGN, SET):
        return _Side(str(path), read_version(path))
    if is_set(path):
        raise DesignError(
            Issue(str(path), "is a set; give the design of one finger, or the folder of one.")
        )

    return _Side(str(path), load_design(path, ()))


def _load_revision(revision: str, path: Path) -> Design:
    """Load a design file, and the adapter that it names, as they were at a revision of git."""
    from fingertip.foundation.files import temporary_folder
    from fingertip.foundation.git_files import read_at_revision
    from fingertip.foundation.tables import read_toml

    with temporary_folder() as folder:
        file = folder / path.name
        file.write_bytes(read_at_revision(revision, path))

        bone = read_toml(file).get("bone")
        adapter = bone.get("adapter_file") if isinstance(bone, dict) else None
        if isinstance(adapter, str) and is_safe_name(adapter):
            (folder / adapter).write_bytes(read_at_revision(revision, path.parent / adapter))

        return load_design(file, ())


def _read(side: _Side, console: Console) -> Version:
    from fingertip.documents.comparison import Version
    from fingertip.tasks.versions import make_version

    if isinstance(side.version, Version):
        return side.version

    return make_version(side.label, side.version, console.progress)


# Output
# ------


def _plan_output(folder: Path, new: Path, force: bool) -> SetWriter:
    """Refuse a folder that cannot take the files, before work starts."""
    from fingertip.foundation.output_set import SetWriter, hash_parameters

    writer = SetWriter(
        folder=folder,
        kind="comparison",
        design=new.stem,
        parameters=hash_parameters(str(new)),
        force=force,
    )
    writer.check((_PAGE, _PICTURE))

    return writer


def _make_files(comparison: Comparison, versions: Sequence[Version]) -> dict[str, bytes]:
    from fingertip.documents.comparison import render_comparison
    from fingertip.pictures.before_after import draw_before_and_after

    old, new = versions
    picture = draw_before_and_after(old.design, new.design, (old.label, new.label))

    return {_PAGE: render_comparison(comparison, _PICTURE).encode(), _PICTURE: picture}


def format_comparison(comparison: Comparison) -> str:
    """Format what changed for a terminal: parameters, figures, parts and checks."""
    changed = [figure for figure in comparison.figures if not figure.is_none]
    blocks = [f"{comparison.after} compared with {comparison.before}: {comparison.summary}"]

    for heading, changes in (
        ("parameter", comparison.parameters),
        ("figure", changed),
        ("volume of a part", comparison.parts),
    ):
        if changes:
            rows = [
                (heading, "before", "after"),
                *((change.name, change.before, change.after) for change in changes),
            ]
            blocks.append("\n".join(align_columns(rows)))

    for heading, names in (
        ("checks that fail now", comparison.broken),
        ("checks that pass now", comparison.mended),
        ("checks gained", comparison.gained),
        ("checks lost", comparison.lost),
    ):
        if names:
            blocks.append(f"{heading}: {', '.join(names)}")

    return "\n\n".join(blocks)
