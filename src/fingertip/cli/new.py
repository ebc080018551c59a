"""Command `fingertip new`: begin a design of one's own, or a set of them for a hand."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
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
    from fingertip.fitting.new_set import Starts


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
    sensor = sensor and spell_sensor(sensor)
    issues = list(find_file_issues("--out", out, ".toml", kept="give another name"))
    issues += _find_name_issues(name, out)
    order = _Order(name, out or Path(f"{name}.toml"), changes or (), issues)

    if old:
        message = "says otherwise what --from takes from the old design; give one of both."
        contrary = {"--sensor": sensor, "--preset": preset, "--hand": hand, "--finger": finger}
        issues += [Issue(option, message) for option, value in contrary.items() if value]
        _write_renewed(console, order, old)
    elif finger:
        from fingertip.fitting.new_set import start_set

        console.fits = True
        _write_set(
            console, order, partial(start_set, name, finger, sensor, preset, hand, order.changes)
        )
    else:
        from fingertip.fitting.new_design import write_new_design

        console.fits = bool(preset or hand or changes)
        begin = partial(
            write_new_design, name, sensor, preset, hand, order.changes, console.progress
        )
        _write_one(console, order, begin, is_new=out is None)


@dataclass(frozen=True)
class _Order:
    """Request for a design or a set, with what is wrong so far."""

    name: str
    path: Path
    changes: Sequence[str]
    issues: list[Issue]

    @property
    def following(self) -> str:
        return f"fingertip make {shlex.quote(self.path.as_posix())}"


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


def _write_one(
    console: Console, order: _Order, begin: Callable[[], NewDesign], is_new: bool
) -> None:
    """Write one design, checked if it was fitted."""
    from fingertip.design.hand_sizes import describe_guesses
    from fingertip.foundation.files import write_file

    new_design = None
    refusals = list[Issue]()
    issues = order.issues
    with gather(refusals):
        new_design = begin()

    issues += _name_options(refusals)
    if new_design and is_new:
        issues += find_file_issues("--out", order.path, ".toml", kept="give another name")
    if issues or new_design is None:
        raise FingertipError(issues)

    data, lines = _describe(order.path, new_design)
    if console.fits:
        console.show_moves(order.name, new_design.moves)
        failed, strength = _check(new_design.design, data, console.progress)
        raise_issues(FingertipError, _refuse(failed))
        lines += strength

    write_file(order.path, new_design.text.encode())
    lines += [
        f"wrote {order.path}; edit it, then run: {order.following}",
        describe_guesses(new_design.guessed),
    ]
    console.result(data | {"next": order.following}, "\n".join(filter(None, lines)))


def _write_renewed(console: Console, order: _Order, old: Path) -> None:
    from fingertip.fitting.renewal import LEFT_OUT, renew_design
    from fingertip.foundation.files import write_file

    order.issues.extend(
        find_file_issues("--out", order.path, ".toml", inputs=(old,), kept="give another name")
    )
    raise_issues(FingertipError, dict.fromkeys(order.issues))

    for left_out in LEFT_OUT:
        renewed = renew_design(
            order.name,
            file=old,
            changes=order.changes,
            left_out=left_out,
            progress=console.progress,
        )
        data, lines = _describe(order.path, renewed.made)
        failed, strength = _check(renewed.made.design, data, console.progress)
        if not failed:
            break
    else:
        raise FingertipError(_refuse(failed))

    write_file(order.path, renewed.made.text.encode())
    columns = max(map(len, renewed.changed), default=0)
    lines += (
        f"{parameter:{columns}}  {was} -> {now}"
        for parameter, (was, now) in renewed.changed.items()
    )
    lines.append(f"{len(renewed.retired)} parameters went; begun from {renewed.made.base}")
    lines += _tell_other_joint(renewed.made)
    data |= {
        "changed": {key: list(both) for key, both in renewed.changed.items()},
        "retired": renewed.retired,
    }
    lines += [*strength, f"wrote {order.path}; edit it, then run: {order.following}"]
    console.result(data | {"next": order.following}, "\n".join(lines))


def _tell_other_joint(new_design: NewDesign) -> Iterator[str]:
    """Yield a note if the bundled design holds more, on another joint."""
    from fingertip.design import Design

    base = Design.load(new_design.base)
    design = new_design.design
    paths = (f"hand.{name}" for name in type(base.hand).model_fields)
    sizes = [
        f"{path}={base.value(path)}" for path in paths if design.value(path) != base.value(path)
    ]
    is_weaker = design.strength.grip_force_n < base.strength.grip_force_n
    if sizes and design.dimensions.joint and is_weaker:
        yield (
            f"note: {new_design.base} holds {base.strength.grip_force_n:g} N, on a joint of "
            f"{', '.join(sizes)}"
        )


def _write_set(console: Console, order: _Order, start: Callable[[], Starts]) -> None:
    from fingertip.design.hand_sizes import describe_guesses
    from fingertip.fitting.new_set import fit_set, write_set_file
    from fingertip.foundation.files import write_file

    path = order.path
    issues = order.issues
    refusals = list[Issue]()
    starts: Starts = {}
    with gather(refusals):
        starts = start()

    issues += _name_options(refusals)
    files = (path.with_name(f"{begun.tables.name}.toml") for begun in starts.values())
    for file in (path, *files):
        issues += find_file_issues("--out", file, ".toml", kept="give another name")

    raise_issues(FingertipError, dict.fromkeys(issues))
    work = Work("", {"fit": 2.0 * len(starts), "checks": len(starts)}, console.progress)
    forms = fit_set(starts, work.within("fit"), issues)
    labels = [join_words(form.fingers) for form in forms]
    checking = Work("checking", dict.fromkeys(labels, 1.0), work.within("checks"))
    form_data: list[dict[str, Any]] = []
    lines = list[str]()
    guessed = dict[str, None]()

    for label, form in zip(labels, forms, strict=True):
        data, details = _describe(path.with_name(form.file), form.design)
        if form.is_own:
            console.show_moves(form.design.design.name, form.design.moves)
            guessed |= dict.fromkeys(form.design.guessed)
            failed, strength = _check(form.design.design, data, checking.within(label))
            issues += (Issue(f"{label}: {issue.field}", issue.message) for issue in _refuse(failed))
            details += strength

        form_data.append(data | {"design": form.file, "fingers": list(form.fingers)})
        lines += [
            f"{label}: {form.file}, begun from {form.design.base}",
            *(f"  {line}" for line in details),
        ]

    raise_issues(FingertipError, issues)
    for form in forms:
        if form.is_own:
            write_file(path.with_name(form.file), form.design.text.encode())

    write_file(path, write_set_file(order.name, forms).encode())
    missing = [finger for finger in NAMES if not any(finger in form.fingers for form in forms)]
    if missing:
        lines.append(f"note: this hand has no {join_words(missing, 'and no')}")

    data = {
        "set": path.as_posix(),
        "name": order.name,
        "forms": form_data,
        "next": order.following,
    }
    lines += [
        f"wrote {path}; edit its designs, then run: {order.following}",
        describe_guesses(guessed),
    ]
    console.result(data, "\n".join(filter(None, lines)))


def _name_options(issues: Iterable[Issue]) -> list[Issue]:
    options = {"name": "NAME", "sensor": "--sensor", "preset": "--preset"}
    return [Issue(options.get(issue.field, issue.field), issue.message) for issue in issues]


def _describe(path: Path, new_design: NewDesign) -> tuple[dict[str, Any], list[str]]:
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


def _check(
    design: Design, data: dict[str, Any], progress: Callable[[str], None]
) -> tuple[list[Check], list[str]]:
    """Check a design as a build does; return the failed checks, and its strength in words."""
    from fingertip.cad.verification.strength import describe_loads, strength_data
    from fingertip.cad.verification.verify import check as check_design

    verification = check_design(design, progress=progress)
    assert verification.strength
    data["strength"] = strength_data(verification.strength)
    failed = [check for check in verification.checks if not check.passed]

    return failed, [describe_loads(verification.strength)]


def _refuse(failed: Iterable[Check]) -> Iterator[Issue]:
    for check in failed:
        problem = (
            f"{check.value:.3g} {check.unit} must be {check.relation} {check.limit:g}, or "
            "`make` fails"
        )
        remedy = f"change {' or '.join(check.change)}"
        if check.remedy:
            remedy = f"it passes with --set {check.remedy}"

        yield Issue(check.name, f"{problem}; {remedy}")
