"""Figures on the pages: none is older than what it rests on, and what counts as a
change of that.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tools.figures.hashing import describe_source, hash_basis
from tools.figures.manifest import (
    FILE,
    Entry,
    Quote,
    find_problems,
    list_pages,
    read_manifest,
    replace_text,
)
from tools.figures.renewal import RenewalError, lay_out, renew

ENTRIES = read_manifest(FILE.read_text(encoding="utf-8"))
TABLE = "src/fingertip/slip/detectors/fast_table.json"
SOURCE = '''\
"""Gain of a stage."""

GAIN = 2.0  # as drawn
"""Gain without a unit."""


def amplify(volts: float, *, twice: bool = False) -> float:
    """Amplify a voltage [V]."""
    return volts * GAIN * (2 if twice else 1)
'''


def test_no_figure_is_older_than_what_it_rests_on() -> None:
    problems = list(find_problems(ENTRIES))
    assert not problems, "\n".join(problems)


def test_every_picture_of_the_pages_is_renewed_by_a_command() -> None:
    shown = {
        path.relative_to(ROOT).as_posix()
        for kind in ("png", "svg", "webp")
        for path in ROOT.glob(f"docs/*.{kind}")
    }
    written = {path for entry in ENTRIES for path in entry.writes}
    assert len(shown) > 10
    assert shown - written == {"docs/measure_your_hand.svg"}, (
        "which tests/design/test_hand_sizes.py draws again"
    )
    linked = " ".join(page.read_text(encoding="utf-8") for page in list_pages())
    assert {path for path in shown if Path(path).name not in linked} == set()


def test_the_manifest_names_each_path_once_and_what_exists() -> None:
    for entry in ENTRIES:
        assert len(entry.rests_on) == len(set(entry.rests_on))
        assert [path for path in entry.rests_on if not (ROOT / path).exists()] == []
        assert entry.rests_on
        assert re.fullmatch(r"20\d\d-\d\d-\d\d", entry.renewed)
    rests_on_the_table = [
        entry.name for entry in ENTRIES if any(TABLE.startswith(path) for path in entry.rests_on)
    ]
    assert {"first_finger", "accuracy", "article", "firmware", "fair_bench"} <= set(
        rests_on_the_table
    )


def copy_detectors(folder: Path) -> Path:
    """Copy the folder of the table of the trees, alone, and return the copied table."""
    copied = folder / TABLE
    copied.parent.mkdir(parents=True)
    for path in (ROOT / TABLE).parent.glob("*.*"):
        (copied.parent / path.name).write_bytes(path.read_bytes())
    return copied


def hash_detectors(folder: Path) -> str:
    return hash_basis(folder, ["src/fingertip/slip/detectors"], ["first_finger"])


def test_one_value_of_a_detectors_table_makes_figures_old_and_a_comment_does_not(
    tmp_path: Path,
) -> None:
    known = hash_detectors(ROOT)
    copy_detectors(tmp_path / "same")
    assert hash_detectors(tmp_path / "same") == known

    table = copy_detectors(tmp_path / "other")
    text = table.read_text(encoding="utf-8")
    value = re.search(r"-?\d+\.\d+", text)
    assert value
    table.write_text(
        text[: value.start()] + f"{float(value[0]) * 1.001}" + text[value.end() :], encoding="utf-8"
    )
    assert hash_detectors(tmp_path / "other") != known

    loop = copy_detectors(tmp_path / "comment").with_name("fast_decision.py")
    loop.write_text("# A comment.\n\n" + loop.read_text(encoding="utf-8"), encoding="utf-8")
    assert hash_detectors(tmp_path / "comment") == known
    assert hash_basis(ROOT, ["src/fingertip/slip/detectors"], ["fsr400"]) != known


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("before", "after", "is_same"),
    [
        ("# as drawn", "# as built", True),
        ('"""Gain without a unit."""', "", True),
        ('    """Amplify a voltage [V]."""\n', "", True),
        ("volts * GAIN", "(volts *\n            GAIN)", True),
        ("2.0", "2.1", False),
        ("2.0", "2", False),
        ("False", "None", False),
        ("*, twice", "twice", False),
        ("volts * GAIN", "GAIN * volts", False),
    ],
)
def test_what_a_source_does_counts_and_not_how_it_reads(
    before: str, after: str, is_same: bool
) -> None:
    assert before in SOURCE
    changed = SOURCE.replace(before, after, 1)
    assert (describe_source(changed) == describe_source(SOURCE)) == is_same


@pytest.fixture
def entry(tmp_path: Path) -> Entry:
    """Entry of a page that quotes one figure, which is current."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text(
        "# Name\n\nOf 120 slips all are\nfound, half within 29 ms.\n"
    )
    (tmp_path / "gain.py").write_text(SOURCE)
    quote = Quote("README.md", "", "Of 120 slips all are found, half within 29 ms.")
    made = Entry(
        name="delay",
        title="The delay",
        commands={"trials": "true"},
        rests_on=("gain.py",),
        presets=(),
        writes=(),
        quotes=(quote,),
        sha256="",
        renewed="2026-11-30",
        seconds=46,
        is_old=False,
    )
    return replace(made, sha256=made.hash_now(tmp_path))


def test_each_fault_names_the_command_that_mends_it(entry: Entry, tmp_path: Path) -> None:
    remedy = "run `python -m tools.figures renew delay` (46 s)"
    assert list(find_problems([entry], tmp_path)) == []
    assert list(find_problems([replace(entry, sha256="0")], tmp_path)) == [
        f"delay: what these figures rest on has changed since 2026-11-30; {remedy}."
    ]
    (missing,) = find_problems([replace(entry, writes=("docs/picture.png",))], tmp_path)
    assert missing == f"delay: docs/picture.png is missing; {remedy}."
    readme = tmp_path / "README.md"
    readme.write_text(readme.read_text().replace("29", "26"))
    (differs,) = find_problems([entry], tmp_path)
    assert differs.startswith("delay: README.md does not hold the recorded 'Of 120")
    assert remedy in differs


def test_old_figures_pass_if_a_page_says_so_and_only_then(entry: Entry, tmp_path: Path) -> None:
    old = replace(entry, sha256="0", is_old=True)
    sentence = "The delay is of 2026-11-30; the program has changed since."
    (silent,) = find_problems([old], tmp_path)
    assert sentence in silent
    readme = tmp_path / "README.md"
    readme.write_text(readme.read_text() + "\n" + sentence.replace("; ", ";\n") + "\n")
    assert list(find_problems([old], tmp_path)) == []
    (current,) = find_problems([entry], tmp_path)
    assert current == f"delay: the figures are current; take {sentence!r} off README.md."


def test_a_sentence_keeps_the_lines_of_its_page_and_a_table_has_its_own() -> None:
    page = "Of 120 slips all\nare found, half within\n26 ms. More.\n\n| a | 1 |\n| b | 2 |\n"
    sentence = "Of 120 slips all are found, half within 26 ms."
    renewed = replace_text(page, sentence, sentence.replace("26", "29"))
    assert renewed == page.replace("26", "29")
    assert replace_text(page, sentence, "None is found.") == page.replace(
        page[: page.index(" More")], "None is found."
    )
    assert replace_text(page, "| a | 1 |\n| b | 2 |", "| a | 3 |\n| b | 4 |").endswith(
        "| a | 3 |\n| b | 4 |\n"
    )
    assert lay_out("\nhalf within\n29 ms.\n") == "half within 29 ms."
    assert lay_out("\n| a | 3 |\n| b | 4 |\n") == "| a | 3 |\n| b | 4 |"
    with pytest.raises(LookupError, match="does not hold 'gone'"):
        replace_text(page, "gone", "here")


MANIFEST = """\
# Kept.
[groups]
stage = ["gain.py"]

[figures.delay]
title = "The delay"
commands.trials = "python trials.py"
rests_on = ["stage"]
writes = ["docs/trials.txt"]
sha256 = ""
renewed = 2020-01-31
seconds = 0
is_old = true

[[figures.delay.quotes]]
page = "README.md"
template = '''
half within
{{ "%.0f" % trials.median_ms }} ms.
'''
text = "half within 29 ms."
"""


@pytest.mark.usefixtures("entry")
def test_a_renewal_runs_the_command_corrects_the_page_and_records_what_it_rests_on(
    tmp_path: Path,
) -> None:
    file = tmp_path / "figures.toml"
    readme = tmp_path / "README.md"
    file.write_text(MANIFEST, encoding="utf-8")
    (tmp_path / "trials.py").write_text(
        "from pathlib import "
        "Path\nPath('docs/trials.txt').write_text('made')\nprint('{\"median_ms\": 31.4}')\n"
    )
    (old,) = read_manifest(MANIFEST)
    renew(old, tmp_path, file)
    assert "half within 31 ms." in readme.read_text()
    assert file.read_text(encoding="utf-8").startswith("# Kept.\n")
    (renewed,) = read_manifest(file.read_text(encoding="utf-8"))
    assert (renewed.is_old, renewed.quotes[0].text) == (False, "half within 31 ms.")
    assert renewed.renewed > old.renewed
    assert list(find_problems([renewed], tmp_path)) == []

    before = file.read_text(encoding="utf-8")
    readme.write_text("# Name\n")
    with pytest.raises(RenewalError, match=r"README.md does not hold 'half within 31 ms\.'"):
        renew(renewed, tmp_path, file)
    with pytest.raises(RenewalError, match="false: exit status 1"):
        renew(replace(renewed, commands={"trials": "false"}, quotes=()), tmp_path, file)
    with pytest.raises(
        RenewalError, match=r"delay: no command renews it; figures\.toml says what does"
    ):
        renew(replace(renewed, commands={}), tmp_path, file)
    assert file.read_text(encoding="utf-8") == before
