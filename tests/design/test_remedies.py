"""Every refusal names remedies, and typing them in gives a design that passes."""

from __future__ import annotations

import os
import random
from collections.abc import Sequence
from functools import cache

import pytest

from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.design.design_file import load_tables
from fingertip.design.fit import fit_lengths
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ELECTRONIC_TABLES, PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.skin import calibration_spans_forces
from fingertip.design.search import Search
from fingertip.foundation.errors import DesignError, Issue, join_words
from tests.conftest import design_file
from tools.fuzz.remedies import FIT, as_changes, read_alternatives, read_remedy

MANY = int(os.environ.get("FINGERTIP_RANDOM_CHANGES", "0"))
"""Random changes per seed; 0 for the usual number."""
NUMERIC = [name for name, field in PARAMETERS.items() if field.annotation in (float, int)]


def refuse(changes: Sequence[str], name: str = "fsr400") -> tuple[Issue, ...]:
    """Issues of a design that is refused; none if it passes."""
    try:
        Design.load(design_file(name), changes=changes)
    except DesignError as error:
        return error.issues
    return ()


@pytest.mark.parametrize("smallest", [5e-324, 1e-307, 1e-3])
def test_search_begins_at_any_positive_number(smallest):
    """The ratio of two numbers of a search may exceed the largest number."""
    tables = DesignTables(name="own").with_values({"force_curve.min_force_n": 0.5})
    found = Search((calibration_spans_forces,), ()).refine(
        tables, "force_curve.max_force_n", smallest, 10.0
    )
    assert 0.5 <= found <= 10.0


def test_a_value_that_was_found_is_rounded_only_to_one_that_passes(monkeypatch):
    low = 10.1234561
    high = 10.1234569
    monkeypatch.setattr(
        Search, "passes", lambda _, tables: low <= tables.force_curve.max_force_n <= high
    )
    found = Search((), ()).refine(DesignTables(name="own"), "force_curve.max_force_n", 10.0, high)
    assert low <= found <= high


def check_remedies(changes: Sequence[str], name: str = "fsr400") -> tuple[Issue, ...]:
    """Type in the remedies of a refusal, all together, and each
    alternative; the design must then pass.
    """
    issues = refuse(changes, name)
    assert not issues or read_remedy(issues[0]), f"{changes}: no remedy in {issues[0]}"
    for issue in issues:
        others = [
            other for other in issues if is_electronic(other.field) != is_electronic(issue.field)
        ]
        ways = [[alternative] for alternative in read_alternatives(issue)]
        if "add --fit" in issue.message:
            loaded = load_tables([design_file(name)], changes)
            fit = fit_lengths(DesignTables(**loaded.tables), loaded.changed)
            assert issue.message.endswith(
                f"add --fit, which moves {join_words(move.name for move in fit.moves)}."
            )
            ways.append([f"{move.name}={move.after!r}" for move in fit.moves])
        for way in ways:
            assert not refuse([*changes, *as_changes(others), *way], name), (
                f"{changes}: {way} of {issue}"
            )
    remedies = as_changes(issues)
    if not any(FIT in read_remedy(issue) for issue in issues):
        assert not refuse([*changes, *remedies], name), f"{changes}: {remedies}"
    return issues


def is_electronic(name: str) -> bool:
    return name.partition(".")[0] in ELECTRONIC_TABLES


def check_change(name: str, preset: str, share: float) -> None:
    """Change one number of a bundled design: a refusal must name
    it first, and its remedies must pass.
    """
    present = load(preset).value(name)
    value = (
        round(share * present)
        if PARAMETERS[name].annotation is int
        else float(f"{share * present:.6g}")
    )
    if value != present and (issues := check_remedies([f"{name}={value!r}"], preset)):
        assert issues[0].field == name, issues


@cache
def load(preset: str) -> Design:
    return Design.load(design_file(preset))


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("preset", "name", "share"),
    [
        ("adult_finger", "skin.width_mm", 0.9),
        ("adult_finger", "hand.tendon_distance_mm", 1.1),
        ("adult_finger", "bone.collar_length_mm", 1.3),
        ("child_thumb", "hand.travel_deg", 1.3),
        ("fsr402", "bone.post_height_mm", 1.1),
        ("article", "board.passband_gain", 1.3),
    ],
)
def test_a_refusal_names_the_changed_parameter_first(preset: str, name: str, share: float) -> None:
    check_change(name, preset, share)


@pytest.mark.full
@pytest.mark.parametrize("preset", sorted(list_bundled_files(DESIGN)))
def test_a_refusal_names_any_changed_number_of_any_bundled_design_first(
    preset: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The fit is tried for one change of each number, and another one
    in each design: it takes most of the time.
    """
    shares = (0.97, 1.03, 0.9, 1.1, 0.7, 1.3)
    for number, name in enumerate(NUMERIC, sorted(list_bundled_files(DESIGN)).index(preset)):
        check_change(name, preset, shares[number % len(shares)])
    monkeypatch.setattr("fingertip.design.design.list_moved", lambda tables, given: None)
    for name in NUMERIC:
        for share in shares:
            check_change(name, preset, share)


def draw_value(random_numbers: random.Random, name: str) -> float:
    """Value of a numeric parameter within its bounds: anywhere, at a bound, or near the default."""
    bounds = find_bounds(PARAMETERS[name])
    default = PARAMETERS[name].default
    assert bounds.maximum is not None
    high = bounds.maximum
    low = bounds.minimum if bounds.minimum is not None else (bounds.above or 0.0) + 1e-3 * high
    draw = random_numbers.random()
    if draw < 0.3 and low > 0.0:
        value = low * (high / low) ** random_numbers.random()
    elif draw < 0.6:
        value = random_numbers.uniform(low, high)
    elif draw < 0.7:
        value = random_numbers.choice((low, high))
    else:
        value = default * 2.0 ** random_numbers.uniform(-1.0, 1.0)
    value = min(max(float(f"{value:.6g}"), low), high)
    return round(value) if PARAMETERS[name].annotation is int else value


@pytest.mark.full
@pytest.mark.parametrize("seed", range(1, 6))
def test_remedies_of_random_changes_pass(seed: int) -> None:
    """Random changes of one or two parameters to both bundled designs."""
    random_numbers = random.Random(seed)
    for _ in range(MANY or 100):
        names = random_numbers.sample(NUMERIC, random_numbers.choice((1, 2)))
        changes = [f"{name}={draw_value(random_numbers, name)!r}" for name in names]
        check_remedies(changes, random_numbers.choice(("fsr400", "fsr402")))


@pytest.mark.full
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.full)])
def test_remedies_of_values_out_of_bounds_pass_after_a_few_rounds(seed: int) -> None:
    """Rules that read an invalid parameter are checked in the next round, once it is valid."""
    random_numbers = random.Random(seed)
    for _ in range(100 if seed else 10):
        invalid, other = random_numbers.sample(NUMERIC, 2)
        bounds = find_bounds(PARAMETERS[invalid])
        outside: float = random_numbers.choice(
            ((bounds.maximum or 0.0) + 1, (bounds.minimum or bounds.above or 0.0) - 1)
        )
        outside = round(outside) if PARAMETERS[invalid].annotation is int else outside
        changes = [f"{invalid}={outside!r}", f"{other}={draw_value(random_numbers, other)!r}"]
        for _ in range(3):
            issues = refuse(changes)
            assert not issues or read_remedy(issues[0]), issues
            changes += as_changes(issues)
        assert not refuse(changes), changes


@pytest.mark.full
def test_refusals_in_python_and_without_remedies_blame_the_same_fields() -> None:
    with pytest.raises(DesignError) as caught:
        Design(bone={"wall_mm": 4.0, "channel_diameter_mm": 9.0})
    assert caught.value.issues == refuse(["bone.wall_mm=4.0", "bone.channel_diameter_mm=9.0"])
    tables = {"bone": {"wall_mm": 4.0}, "board": {"capacitor_uf": 100.0}}
    with pytest.raises(DesignError) as quick:
        Design.without_remedies(**tables)
    with pytest.raises(DesignError) as full:
        Design(**tables)
    assert {issue.field for issue in quick.value.issues} == {
        issue.field for issue in full.value.issues
    }
    assert not any(
        "at most" in issue.message or "set " in issue.message for issue in quick.value.issues
    )
    assert Design.without_remedies(skin={"width_mm": 18.0}) == Design(skin={"width_mm": 18.0})
