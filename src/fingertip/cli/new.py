"""Command `fingertip new`: begin a design of one's own, or a set of them for a hand."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.catalogues.electronics import NAMES, spell_sensor
from fingertip.cli.console import Console
from fingertip.cli.options import CHANGES, command, find_file_issues, parse_design
from fingertip.foundation.errors import (
    FingertipError,
    Issue,
    gather,
    join_words,
    quote_value,
    raise_issues,
)
from fingertip.foundation.input_files import is_safe_name
from fingertip.foundation.progress import Work

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design
    from fingertip.fitting.new_design import NewDesign
    from fingertip.fitting.new_set import NewForm, Starts
    from fingertip.fitting.renewal import Renewal

_KEPT = "give another name"
"""Remedy where a file exists."""


@command
def new(
    console: Console,
    name: str = typer.Argument(help="Name of the design: up to 40 letters, digits, - and _."),
    sensor: str | None = typer.Option(
        None, help="Sensor: {sensors} (see the file); fsr400 by default."
    ),
    preset: str | None = typer.Option(None, help="Anatomical size, with a joint: {presets}."),
    hand: str | None = typer.Option(
        None,
        metavar="FILE",
        help="File with the sizes of your hand's joint, or a bundled hand: {hands}.",
    ),
    finger: list[str] | None = typer.Option(
        None,
        metavar="NAME=WIDTHxLENGTH",
        help="Finger of a hand ({fingers}) with its skin's width at the edge and length "
        "from tip to edge, in mm, such as index=18x25; repeatable. Writes a set and a design for "
        "each size.",
    ),
    old: Path | None = typer.Option(
        None,
        "--from",
        parser=parse_design,
        metavar="FILE",
        help="Design file of an earlier version, whose sizes the new design keeps.",
    ),
    out: Path | None = typer.Option(
        None, "--out", "-o", metavar="FILE", help="File to write; NAME.toml by default."
    ),
    changes: list[str] | None = CHANGES,
) -> None:
    """Write a design file to be edited: what you wish and what you measured, and all other
    parameters as comments.

    The bundled design of the sensor is the base, or the preset. What follows from the sizes is
    fitted until the design can be made, and its parts are checked. What is changed with --set
    stays, and no size of the hand moves. Loads that are not set become those that the finger holds.
    An existing file is never overwritten.

    With --finger, once for each finger of a hand, it writes a set of fingers on one joint, and
    beside it a design for each size. The preset is then that whose widths are nearest.

    With --from, skin, hand, board, detector and printer are those of a design of an earlier
    version, as far as the rules allow; a table says what changed. Loads that its bone does not hold
    become those that it holds.
    """
    order = _Order(
        name=name,
        out=out,
        sensor=sensor and spell_sensor(sensor),
        preset=preset,
        hand=hand,
        fingers=finger or (),
        changes=changes or (),
    )
    issues = [*find_file_issues("--out", out, ".toml", kept=_KEPT), *_find_name_issues(name, out)]

    if old:
        issues += _find_contrary_options(order)
        _write_renewed(console, order, old, issues)
    elif finger:
        console.fits = True
        _write_set(console, order, issues)
    else:
        console.fits = bool(preset or hand or changes)
        _write_one(console, order, issues)


@dataclass(frozen=True)
class _Order:
    """Design or set that is asked for."""

    name: str
    out: Path | None
    sensor: str | None
    preset: str | None
    hand: str | None
    fingers: Sequence[str]
    changes: Sequence[str]

    @property
    def path(self) -> Path:
        return self.out or Path(f"{self.name}.toml")

    @property
    def following(self) -> str:
        """Command to run next."""
        return f"fingertip make {shlex.quote(self.path.as_posix())}"


# Issues of the options.


def _find_name_issues(name: str, out: Path | None) -> Iterator[Issue]:
    """Yield an issue if a bundled file has the name, or Windows makes no file of it."""
    from fingertip.catalogues.file_kinds import DESIGN, SET, list_bundled_files

    if not is_safe_name(f"{name}.toml") and name.isalnum():
        yield Issue("NAME", f"{name} names no file on Windows; choose another, such as my_{name}.")
    if out and not is_safe_name(out.name):
        yield Issue(
            "--out",
            f"{quote_value(out.name)} names no file on Windows; choose another, such as "
            f"{name}.toml.",
        )

    for kind in (DESIGN, SET):
        if name in list_bundled_files(kind):
            problem = f"{name} is the name of a bundled {kind.name}"
            yield Issue("NAME", f"{problem}; choose another, such as my_{name}.")


def _find_contrary_options(order: _Order) -> Iterator[Issue]:
    """Yield an issue for each option that cannot stand beside --from."""
    options = {
        "--sensor": order.sensor,
        "--preset": order.preset,
        "--hand": order.hand,
        "--finger": order.fingers,
    }
    for option, value in options.items():
        if value:
            message = "says otherwise what --from takes from the old design; give one of both."
            yield Issue(option, message)


def _name_options(issues: Iterable[Issue]) -> list[Issue]:
    """Name the options of the command in issues of the library."""
    options = {"name": "NAME", "sensor": "--sensor", "preset": "--preset"}
    return [Issue(options.get(issue.field, issue.field), issue.message) for issue in issues]


# One design.


def _write_one(console: Console, order: _Order, issues: Iterable[Issue]) -> None:
    """Write one design, checked if it was fitted."""
    from fingertip.design.hand_sizes import describe_guesses
    from fingertip.foundation.files import write_file

    new_design = _begin_one(order, issues, console.progress)
    data, lines = _describe(order.path, new_design)

    if console.fits:
        console.show_moves(order.name, new_design.moves)
        checked = _check(new_design.design, console.progress)
        raise_issues(FingertipError, checked.issues)
        data |= checked.data
        lines.append(checked.loads)

    write_file(order.path, new_design.text.encode())
    lines += [
        f"wrote {order.path}; edit it, then run: {order.following}",
        describe_guesses(new_design.guessed),
    ]
    console.result(data | {"next": order.following}, "\n".join(filter(None, lines)))


def _begin_one(
    order: _Order, issues: Iterable[Issue], progress: Callable[[str], None]
) -> NewDesign:
    """Begin and fit a design. Raises FingertipError with these issues and all others."""
    from fingertip.fitting.new_design import write_new_design

    new_design = None
    refusals: list[Issue] = []
    with gather(refusals):
        new_design = write_new_design(
            name=order.name,
            sensor=order.sensor,
            preset=order.preset,
            hand=order.hand,
            changes=order.changes,
            progress=progress,
        )

    issues = [*issues, *_name_options(refusals)]
    if new_design and order.out is None:
        issues += find_file_issues("--out", order.path, ".toml", kept=_KEPT)
    if issues or new_design is None:
        raise FingertipError(issues)

    return new_design


# Design of an earlier version.


def _write_renewed(console: Console, order: _Order, old: Path, issues: Iterable[Issue]) -> None:
    """Write a design with the sizes of an old one."""
    from fingertip.foundation.files import write_file

    out_issues = find_file_issues("--out", order.path, ".toml", inputs=(old,), kept=_KEPT)
    raise_issues(FingertipError, dict.fromkeys([*issues, *out_issues]))

    renewed, checked = _renew(order, old, console.progress)
    data, lines = _describe(order.path, renewed.made)
    write_file(order.path, renewed.made.text.encode())

    lines += _list_changed(renewed)
    lines.append(f"{len(renewed.retired)} parameters went; begun from {renewed.made.base}")
    lines += _tell_other_joint(renewed.made)
    lines.append(checked.loads)
    lines.append(f"wrote {order.path}; edit it, then run: {order.following}")

    data |= checked.data
    data["changed"] = {key: list(both) for key, both in renewed.changed.items()}
    data["retired"] = renewed.retired
    data["next"] = order.following
    console.result(data, "\n".join(lines))


def _renew(
    order: _Order, old: Path, progress: Callable[[str], None]
) -> tuple[Renewal, _CheckedDesign]:
    """Renew a design with as many of its sizes as pass the checks. Raises FingertipError."""
    from fingertip.fitting.renewal import LEFT_OUT, renew_design

    for left_out in LEFT_OUT:
        renewed = renew_design(
            order.name,
            file=old,
            changes=order.changes,
            left_out=left_out,
            progress=progress,
        )
        checked = _check(renewed.made.design, progress)
        if not checked.issues:
            return renewed, checked

    raise FingertipError(checked.issues)


def _list_changed(renewed: Renewal) -> list[str]:
    width = max(map(len, renewed.changed), default=0)
    return [
        f"{parameter:{width}}  {was} -> {now}" for parameter, (was, now) in renewed.changed.items()
    ]


def _tell_other_joint(new_design: NewDesign) -> Iterator[str]:
    """Yield a note if the bundled design holds more, on another joint."""
    from fingertip.design import Design

    base = Design.load(new_design.base)
    design = new_design.design
    paths = [f"hand.{name}" for name in type(base.hand).model_fields]
    sizes = [
        f"{path}={base.value(path)}" for path in paths if design.value(path) != base.value(path)
    ]
    is_weaker = design.strength.grip_force_n < base.strength.grip_force_n
    if sizes and design.dimensions.joint and is_weaker:
        force_n = f"{base.strength.grip_force_n:g} N"
        joint = ", ".join(sizes)
        yield f"note: {new_design.base} holds {force_n}, on a joint of {joint}"


# Set of designs.


def _write_set(console: Console, order: _Order, issues: Iterable[Issue]) -> None:
    """Write a set, and a design for each size that no bundled one has."""
    from fingertip.design.hand_sizes import describe_guesses
    from fingertip.fitting.new_set import fit_set, write_set_file
    from fingertip.foundation.files import write_file

    starts = _begin_set(order, issues)
    work = Work("", {"fit": 2.0 * len(starts), "checks": len(starts)}, console.progress)
    fit_issues: list[Issue] = []
    forms = fit_set(starts, work.within("fit"), fit_issues)
    described = _describe_forms(console, order, forms, work.within("checks"))
    raise_issues(FingertipError, fit_issues, described.issues)

    for form in forms:
        if form.is_own:
            write_file(order.path.with_name(form.file), form.design.text.encode())

    write_file(order.path, write_set_file(order.name, forms).encode())
    data = {
        "set": order.path.as_posix(),
        "name": order.name,
        "forms": described.data,
        "next": order.following,
    }
    guessed = [size for form in forms if form.is_own for size in form.design.guessed]
    lines = [
        *described.lines,
        _tell_missing_fingers(forms),
        f"wrote {order.path}; edit its designs, then run: {order.following}",
        describe_guesses(dict.fromkeys(guessed)),
    ]
    console.result(data, "\n".join(filter(None, lines)))


def _begin_set(order: _Order, issues: Iterable[Issue]) -> Starts:
    """Begin the designs of a set. Raises FingertipError with these issues and all others."""
    from fingertip.fitting.new_set import start_set

    starts: Starts = {}
    refusals: list[Issue] = []
    with gather(refusals):
        starts = start_set(
            name=order.name,
            texts=order.fingers,
            sensor=order.sensor,
            preset=order.preset,
            hand=order.hand,
            changes=order.changes,
        )

    issues = [*issues, *_name_options(refusals)]
    names = [start.tables.name for start in starts.values()]
    for path in (order.path, *(order.path.with_name(f"{name}.toml") for name in names)):
        issues += find_file_issues("--out", path, ".toml", kept=_KEPT)

    raise_issues(FingertipError, dict.fromkeys(issues))
    return starts


@dataclass(frozen=True)
class _DescribedForms:
    """Designs of a set for --json and for people, and what refuses them."""

    data: Sequence[Mapping[str, Any]]
    lines: Sequence[str]
    issues: Sequence[Issue]


def _describe_forms(
    console: Console,
    order: _Order,
    forms: Sequence[NewForm],
    progress: Callable[[str], None],
) -> _DescribedForms:
    """Describe the designs of a set, and check those that are no bundled ones."""
    labels = [join_words(form.fingers) for form in forms]
    checking = Work("checking", dict.fromkeys(labels, 1.0), progress)
    form_data: list[dict[str, Any]] = []
    lines: list[str] = []
    issues: list[Issue] = []

    for label, form in zip(labels, forms, strict=True):
        data, details = _describe(order.path.with_name(form.file), form.design)
        if form.is_own:
            console.show_moves(form.design.design.name, form.design.moves)
            checked = _check(form.design.design, checking.within(label))
            issues += [Issue(f"{label}: {issue.field}", issue.message) for issue in checked.issues]
            data |= checked.data
            details.append(checked.loads)

        form_data.append(data | {"design": form.file, "fingers": list(form.fingers)})
        lines.append(f"{label}: {form.file}, begun from {form.design.base}")
        lines += [f"  {line}" for line in details]

    return _DescribedForms(form_data, lines, issues)


def _tell_missing_fingers(forms: Sequence[NewForm]) -> str:
    """Name the fingers that a hand lacks; empty if it has all."""
    present = {finger for form in forms for finger in form.fingers}
    missing = [finger for finger in NAMES if finger not in present]
    return f"note: this hand has no {join_words(missing, 'and no')}" if missing else ""


# Description and checks of a design.


def _describe(path: Path, new_design: NewDesign) -> tuple[dict[str, Any], list[str]]:
    """Describe a design for --json, and for people."""
    design = new_design.design
    data: dict[str, Any] = {
        "design": path.as_posix(),
        "name": design.name,
        "sensor": design.sensor.model,
        "base": new_design.base,
        "guessed": list(new_design.guessed),
    }
    lines = [f"note: {doubt}" for doubt in design.force_curve.find_doubt(design.sensor.model)]

    if design.dimensions.joint:
        short = design.dimensions.sensor.short
        axis_mm = design.skin.length_mm + design.bone.base_length_mm
        shorter = f"; {short} allows less" if short else ""
        lines.append(f"{axis_mm:.1f} mm from the tip to the axis of the joint{shorter}")

    return data, lines


@dataclass(frozen=True)
class _CheckedDesign:
    """Result of the checks of a design."""

    issues: Sequence[Issue]
    """An issue for each check that failed."""
    loads: str
    """Loads that it holds, in words."""
    data: Mapping[str, Any]
    """The same for --json."""


def _check(design: Design, progress: Callable[[str], None]) -> _CheckedDesign:
    """Check a design as a build does."""
    from fingertip.cad.verification.strength import describe_loads, strength_data
    from fingertip.cad.verification.verify import check as check_design

    verification = check_design(design, progress=progress)
    assert verification.strength

    return _CheckedDesign(
        issues=[_refuse(check) for check in verification.checks if not check.passed],
        loads=describe_loads(verification.strength),
        data={"strength": strength_data(verification.strength)},
    )


def _refuse(check: Check) -> Issue:
    """State what a failed check asks for."""
    problem = (
        f"{check.value:.3g} {check.unit} must be {check.relation} {check.limit:g}, or `make` fails"
    )
    remedy = f"change {' or '.join(check.change)}"
    if check.remedy:
        remedy = f"it passes with --set {check.remedy}"

    return Issue(check.name, f"{problem}; {remedy}")
