"""Command `fingertip new`: begin a design of one's own, or a set of them for a hand."""

from __future__ import annotations

import contextlib
import itertools
import math
import shlex
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.catalogues.electronics import NAMES
from fingertip.cli.console import Console
from fingertip.cli.options import CHANGES, command, find_file_issues, flag
from fingertip.foundation.errors import DesignError, FingertipError, Issue, gather, join_words
from fingertip.foundation.progress import ReportProgress, Work

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design
    from fingertip.design.new_design import NewDesign
    from fingertip.design.new_set import Starts

_LARGER_MM = (1.0, 2.0, 3.0, 4.0)
"""Widths by which a finger that fails is made larger, and its height by half of them, until one passes [mm]."""


@command
def new(
    console: Console,
    name: str = typer.Argument(help="Name of the design: up to 40 letters, digits, - and _."),
    sensor: str | None = typer.Option(None, help="Sensor: {sensors} (see the file); fsr400 by default."),
    preset: str | None = typer.Option(None, help="Anatomical size, with a joint: {presets}."),
    hand: str | None = typer.Option(
        None, metavar="FILE", help="File with the sizes of your hand's joint, or a bundled hand: {hands}."
    ),
    finger: list[str] | None = typer.Option(
        None,
        metavar="NAME=WIDTHxLENGTH",
        help="Finger of a hand ({fingers}) with its skin's width at the edge and length "
        "from tip to edge, in mm, such as index=18x25; repeatable. Writes a set and a design for each size.",
    ),
    old: Path | None = typer.Option(
        None, "--from", metavar="FILE", help="Design file of an earlier version, whose sizes the new design keeps."
    ),
    out: Path | None = typer.Option(None, "--out", "-o", metavar="FILE", help="File to write; NAME.toml by default."),
    allow_shorter_travel: bool = flag("Let the finger bend less, or its tendon lie nearer the joint."),
    changes: list[str] | None = CHANGES,
) -> None:
    """Write a design file with comments, to be edited: the main parameters, and all others as comments.

    The bundled design of the sensor is the base, or the preset. With a preset or a hand, lengths that nobody measures
    are fitted until the design can be made, and its parts are checked; what is changed with --set stays. An existing
    file is never overwritten.

    With --finger, once for each finger of a hand, it writes a set of fingers on one joint, and beside it a design for
    each size. The preset is then that whose widths are nearest.

    With --from, skin, hand, board, detector and printer are those of a design of an earlier version, as far as the
    rules allow; a table says what changed. Loads that its bone does not hold become those that it holds.
    """
    issues = list(find_file_issues("--out", out, ".toml", kept="give another name"))
    issues += _find_taken(name)
    order = _Order(name, out or Path(f"{name}.toml"), changes or (), allow_shorter_travel, issues)
    if old:
        others = {"--sensor": sensor, "--preset": preset, "--hand": hand, "--finger": finger}
        for option in (option for option, value in others.items() if value):
            issues.append(Issue(option, "says otherwise what --from takes from the old design; give one of both."))
        _write_renewed(console, order, old)
    elif finger:
        from fingertip.design.new_set import start_set

        _write_set(console, order, partial(start_set, name, finger, sensor, preset, hand, order.changes))
    else:
        from fingertip.design.new_design import write_new_design

        begin = partial(write_new_design, name, sensor, preset, hand, progress=console.progress)
        _write_one(console, order, begin, is_new=out is None, is_fitted=bool(preset or hand))


@dataclass(frozen=True)
class _Order:
    """Design, or set, that is asked for, and what is wrong with the words so far."""

    name: str
    path: Path
    changes: Sequence[str]
    may_change_joint: bool
    issues: list[Issue]

    @property
    def following(self) -> str:
        return f"fingertip make {shlex.quote(self.path.as_posix())}"


def _find_taken(name: str) -> Iterator[Issue]:
    """Find why a name is refused: a bundled file has it."""
    from fingertip.catalogues.file_kinds import DESIGN, SET, list_bundled_files

    for kind in (DESIGN, SET):
        if name in list_bundled_files(kind):
            taken = f"{name} is the name of a bundled {kind.name}"
            yield Issue("NAME", f"{taken}; choose another, such as my_{name}.")


def _write_one(console: Console, order: _Order, begin: Callable[..., NewDesign], is_new: bool, is_fitted: bool) -> None:
    """Write one design, checked if its lengths are fitted."""
    from fingertip.design.new_design import find_lost_travel
    from fingertip.foundation.files import write_file

    made, found, issues = None, list[Issue](), order.issues
    with gather(found):
        made = begin(changes=order.changes)
        if not order.may_change_joint:
            found += find_lost_travel(made)
    issues += _name_options(found)
    if made and is_new:
        issues += find_file_issues("--out", order.path, ".toml", kept="give another name")
    if issues or made is None:
        raise FingertipError(issues)
    data, lines = _describe(order.path, made)
    if is_fitted:
        failed, strength = _check(made.design, data, console.progress)
        if failed:
            remedy = _find_passing(order, begin, made.design, failed, console.progress)
            raise FingertipError(_refuse(failed, remedy))
        lines += strength
    write_file(order.path, made.text.encode())
    lines.append(f"wrote {order.path}; edit it, then run: {order.following}")
    console.result(data | {"next": order.following}, "\n".join(lines))


def _write_renewed(console: Console, order: _Order, old: Path) -> None:
    from fingertip.design.renewal import LEFT_OUT, renew_design
    from fingertip.foundation.files import write_file

    order.issues.extend(find_file_issues("--out", order.path, ".toml", inputs=(old,), kept="give another name"))
    if order.issues:
        raise FingertipError(dict.fromkeys(order.issues))
    for left in LEFT_OUT:
        renewed = renew_design(order.name, old, order.changes, left, console.progress)
        data, lines = _describe(order.path, renewed.made)
        failed, strength = _check(renewed.made.design, data, console.progress)
        if lighter := _find_lighter_loads([failed]):
            loads = [f"{load}={value:g}" for load, value in lighter.items()]
            renewed = renew_design(order.name, old, [*order.changes, *loads], left, console.progress)
            failed, strength = _check(renewed.made.design, data, console.progress)
        if not failed:
            break
    else:
        raise FingertipError(_refuse(failed, ""))
    write_file(order.path, renewed.made.text.encode())
    columns = max(map(len, renewed.changed), default=0)
    lines += (f"{parameter:{columns}}  {was} -> {now}" for parameter, (was, now) in renewed.changed.items())
    lines.append(f"{len(renewed.retired)} parameters went; begun from {renewed.made.base}")
    lines += _tell_other_joint(renewed.made)
    data |= {"changed": {key: list(both) for key, both in renewed.changed.items()}, "retired": renewed.retired}
    lines += [*strength, f"wrote {order.path}; edit it, then run: {order.following}"]
    console.result(data | {"next": order.following}, "\n".join(lines))


def _tell_other_joint(made: NewDesign) -> Iterator[str]:
    """Tell with which joint of the hand the bundled design holds more than the new one."""
    from fingertip.design import Design

    base, design = Design.load(made.base), made.design
    paths = (f"hand.{name}" for name in type(base.hand).model_fields)
    others = [f"{path}={base.value(path)}" for path in paths if design.value(path) != base.value(path)]
    if others and design.dimensions.joint and design.strength.grip_force_n < base.strength.grip_force_n:
        yield f"note: {made.base} holds {base.strength.grip_force_n:g} N, on a joint of {', '.join(others)}"


def _write_set(console: Console, order: _Order, start: Callable[[], Starts]) -> None:
    from fingertip.design.new_set import fit_set, write_set_file
    from fingertip.foundation.files import write_file

    path, issues, found = order.path, order.issues, list[Issue]()
    starts: Starts = {}
    with gather(found):
        starts = start()
    issues += _name_options(found)
    for file in (path, *(path.with_name(f"{one.tables.name}.toml") for one in starts.values())):
        issues += find_file_issues("--out", file, ".toml", kept="give another name")
    if issues:
        raise FingertipError(dict.fromkeys(issues))
    work = Work("", {"fit": 2.0 * len(starts), "checks": len(starts)}, console.progress)
    forms = fit_set(starts, order.may_change_joint, work.within("fit"), issues)
    checking = Work("checking", dict.fromkeys((join_words(form.fingers) for form in forms), 1.0), work.within("checks"))
    form_data: list[dict[str, Any]] = []
    lines: list[str] = []
    weak: dict[str, list[Check]] = {}
    for form in forms:
        label = join_words(form.fingers)
        data, details = _describe(path.with_name(form.file), form.design)
        if form.is_own:
            weak[label], strength = _check(form.design.design, data, checking.within(label))
            details += strength
        form_data.append(data | {"design": form.file, "fingers": list(form.fingers)})
        lines += [f"{label}: {form.file}, begun from {form.design.base}", *(f"  {line}" for line in details)]
    loads = _offer_lighter_loads(weak.values(), "all fingers hold")
    for label, failed in weak.items():
        issues += (Issue(f"{label}: {issue.field}", issue.message) for issue in _refuse(failed, loads))
    if issues:
        raise FingertipError(issues)
    for form in forms:
        if form.is_own:
            write_file(path.with_name(form.file), form.design.text.encode())
    write_file(path, write_set_file(order.name, forms).encode())
    if missing := [finger for finger in NAMES if not any(finger in form.fingers for form in forms)]:
        lines.append(f"note: this hand has no {join_words(missing, 'and no')}")
    data = {"set": path.as_posix(), "name": order.name, "forms": form_data, "next": order.following}
    console.result(data, "\n".join([*lines, f"wrote {path}; edit its designs, then run: {order.following}"]))


def _name_options(issues: Iterable[Issue]) -> list[Issue]:
    options = {"name": "NAME", "sensor": "--sensor", "preset": "--preset"}
    return [Issue(options.get(issue.field, issue.field), issue.message) for issue in issues]


def _describe(path: Path, made: NewDesign) -> tuple[dict[str, Any], list[str]]:
    data: dict[str, Any] = {
        "design": path.as_posix(), "name": made.design.name, "sensor": made.design.sensor.model, "base": made.base,
        "fitted": {name: list(values) for name, values in made.fitted.items()}, "reasons": dict(made.reasons),
    }  # fmt: skip
    to_axis_mm = made.design.skin.length_mm + made.design.bone.base_length_mm
    lines = [f"{to_axis_mm:.1f} mm from the tip to the axis of the joint"] if made.design.dimensions.joint else []
    lines += (f"fitted: {name} {before:g} -> {after:g}" for name, (before, after) in made.fitted.items())
    lines += [f"note: {reason}: a measured value was changed" for reason in made.reasons.values()]
    return data, lines


def _check(design: Design, data: dict[str, Any], progress: Callable[[str], None]) -> tuple[list[Check], list[str]]:
    """Check a design as a build does, and add its strength to the data. Return what failed, and its strength."""
    from fingertip.cad.verification.strength import describe_loads, strength_data
    from fingertip.cad.verification.verify import check as check_design

    verified = check_design(design, progress=progress)
    assert verified.strength
    data["strength"] = strength_data(verified.strength)
    failed = [check for check in verified.checks if not check.passed]
    return failed, [describe_loads(verified.strength)]


def _refuse(failed: Iterable[Check], remedy: str) -> Iterator[Issue]:
    for check in failed:
        problem = f"{check.value:.3g} {check.unit} must be {check.relation} {check.limit:g}, or `make` fails"
        change = f"change {' or '.join(check.change)} with --set"
        yield Issue(check.name, f"{problem}; {remedy or change}")


def _find_passing(
    order: _Order, begin: Callable[..., NewDesign], design: Design, failed: Sequence[Check], progress: ReportProgress
) -> str:
    """Find the first larger finger that passes every check, as options to be typed; else loads that this one holds."""
    from fingertip.cad.verification.verify import check as check_design
    from fingertip.design.new_design import find_lost_travel

    shares = {"skin.width_mm": 1.0, "skin.semi_axis_dorsal_mm": 0.5}
    free = {name: by for name, by in shares.items() if not any(change.startswith(name) for change in order.changes)}
    for larger_mm in _LARGER_MM if free else ():
        settings = [f"{name}={design.value(name) + by * larger_mm:g}" for name, by in free.items()]
        progress(f"trying a larger finger: {' '.join(settings)}")
        with contextlib.suppress(DesignError):
            made = begin(changes=[*order.changes, *settings])
            may_lose = order.may_change_joint or not find_lost_travel(made)
            found = {check.name: check for check in check_design(made.design, progress=progress).checks}
            if may_lose and all(check.passed for check in found.values()):
                return "it passes with " + " ".join(f"--set {setting}" for setting in settings)
            # A fit may take a minute: go on only if the largest finger reaches what this step has gained in proportion.
            steps = _LARGER_MM[-1] / larger_mm
            factors = [check for check in failed if check.name.startswith("bone.safety_factor.")]
            if any(one.value + steps * (found[one.name].value - one.value) < one.limit for one in factors):
                break
    return _offer_lighter_loads([failed], "it holds")


def _find_lighter_loads(weak: Iterable[Sequence[Check]]) -> dict[str, float]:
    """Find loads that all bones hold which are too weak for theirs; none if more fails."""
    loads: dict[str, float] = {}
    for check in itertools.chain(*weak):
        if not check.remedy:
            return {}
        for name, load in (setting.split("=") for setting in check.remedy.split(" --set ")):
            loads[name] = min(float(load), loads.get(name, math.inf))
    return loads


def _offer_lighter_loads(weak: Iterable[Sequence[Check]], who: str) -> str:
    """Offer loads that all bones hold, as options to be typed; nothing if there are none."""
    settings = " ".join(f"--set {name}={load:g}" for name, load in _find_lighter_loads(weak).items())
    return f"{who} lighter loads: {settings}" if settings else ""
