"""`fingertip compare`: what a change of a design changes, from reports alone."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
from pathlib import Path

import pytest
from PIL import Image

from fingertip import Design
from fingertip.documents.comparison import Version, compare_versions
from fingertip.tasks.build import build
from fingertip.tasks.versions import read_version
from tests.conftest import run_fingertip

COARSE_MM = 0.1


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of parts without a trial."""
    folder = tmp_path_factory.mktemp("compare") / "before"
    build(Design.load("first_finger"), folder, formats=["stl"], tolerance_mm=COARSE_MM)
    return folder


@pytest.fixture(scope="module")
def after(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the same finger, a little wider."""
    folder = tmp_path_factory.mktemp("compare") / "after"
    wider = Design.load("first_finger", changes=["skin.width_mm=19.3", "strength.grip_force_n=15"])
    build(wider, folder, formats=["stl"], tolerance_mm=COARSE_MM)
    return folder


@pytest.mark.second
def test_differences_are_those_of_the_reports(before: Path, after: Path) -> None:
    done = run_fingertip("compare", before, after, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert {change["name"]: change["after"] for change in found["parameters"]} == {
        "skin.width_mm": "19.3 mm",
        "strength.grip_force_n": "15 N",
    }

    report = json.loads((after / "report.json").read_text())
    figures = {change["name"]: change["after"] for change in found["figures"]}
    assert figures["printed material"] == f"{report['casting']['printed_g']:g} g"
    assert (
        figures["share of a force at the sensor"]
        == f"{100 * report['pad']['tilts'][2]['share']:.4g} %"
    )
    assert figures["delay of slip detection, one simulated trial"] == "-", "only make simulates one"
    volumes = {change["name"]: change["after"] for change in found["parts"]}
    assert volumes["skin"] == f"{float(format(report['parts']['skin']['volume_mm3'], '.4g')):g} mm3"


def test_checks_gained_lost_mended_and_broken_are_named(before: Path) -> None:
    old = read_version(before)
    checks = [dict(check) for check in old.report["checks"]]
    gone = checks.pop(0)
    broken = checks[0]
    broken["passed"] = False
    checks.append({"name": "new.check", "passed": True})
    new = Version("new", old.design, {**old.report, "checks": checks}, {"delays_s": [0.0255]})

    found = compare_versions(old, new)
    assert (found.lost, found.gained) == ((gone["name"],), ("new.check",))
    assert (found.broken, found.mended) == ((broken["name"],), ())
    assert compare_versions(new, old).mended == (broken["name"],)
    (delay,) = (figure for figure in found.figures if "delay" in figure.name)
    assert (delay.before, delay.after) == ("-", "25.5 ms")


def test_a_version_compared_with_itself_has_not_changed(before: Path) -> None:
    done = run_fingertip("compare", before, before)
    assert "nothing changed" in done.stdout


def test_report_of_another_release_without_some_figures_is_compared(
    before: Path, tmp_path: Path
) -> None:
    old = Path(shutil.copytree(before, tmp_path / "old"))
    for report in (
        {"pad": {"tilts": [1]}, "checks": [2], "casting": []},
        {"pad": {"tilts": None}, "checks": None, "parts": None},
        {"casting": {"things": [{"new": 1}], "printed_g": 10**400}, "parts": {"bone": []}},
        {"pad": [], "parts": {"bone": {"volume_mm3": "5"}}},
    ):
        (old / "report.json").write_text(json.dumps(report))
        done = run_fingertip("compare", old, before, "--json")
        assert done.returncode == 0, done.stderr
        unknown = [
            change["name"]
            for change in json.loads(done.stdout)["figures"]
            if change["before"] != "-"
        ]
        assert unknown in ([], ["to order"])


def test_part_of_another_shape_and_the_same_volume_is_named(before: Path) -> None:
    old = read_version(before)
    parts = {name: dict(entry) for name, entry in old.report["parts"].items()}
    parts["core"]["sha256"] = {"stl": "0" * 64}
    found = compare_versions(old, Version("new", old.design, {**old.report, "parts": parts}, {}))
    assert [(change.name, change.after.partition(", ")[2]) for change in found.parts] == [
        ("core", "another shape")
    ]


def test_checks_of_formats_that_one_side_lacks_are_not_lost(before: Path, tmp_path: Path) -> None:
    build(
        Design.load("first_finger"),
        tmp_path / "both",
        formats=["stl", "3mf"],
        tolerance_mm=COARSE_MM,
    )
    found = compare_versions(read_version(tmp_path / "both"), read_version(before))
    assert (found.lost, found.gained) == ((), ())


def test_page_and_picture_are_written_beside_each_other(
    before: Path, after: Path, tmp_path: Path
) -> None:
    out = tmp_path / "comparison"
    for _ in range(2):  # it may be written again
        assert run_fingertip("compare", before, after, "--out", out).returncode == 0
    assert "](comparison.png)" in (out / "comparison.md").read_text()
    picture = Image.open(io.BytesIO((out / "comparison.png").read_bytes())).convert("RGB")
    colours = {colour for _, colour in picture.getcolors(1 << 20) or []}
    assert {(200, 40, 30), (20, 70, 190)} <= colours, "both outlines are seen"


@pytest.mark.full
def test_design_is_compared_with_a_revision_of_git(tmp_path: Path) -> None:
    design = tmp_path / "designs" / "index.toml"
    design.parent.mkdir()
    design.write_text('name = "index"\n')
    git = ("git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@example.org")
    for words in (("init", "-q"), ("add", "."), ("commit", "-qm", "first")):
        subprocess.run([*git, *words], check=True)
    design.write_text('name = "index"\n[skin]\nwidth_mm = 17.4\n')
    done = run_fingertip("compare", "HEAD", design, "--json", "--quiet")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert [change["name"] for change in found["parameters"]] == ["skin.width_mm"]
    assert not any(change["before"] == "-" for change in found["figures"])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("no_such", "first_finger", "OLD: no_such: is no design and no folder"),
        ("adult_hand", "first_finger", "OLD: adult_hand: is a set"),
        ("first_finger", "missing.toml", "NEW: missing.toml: cannot be read"),
        ("first_finger", ".", "NEW: .: is a folder without the report.json of build or make"),
    ],
)
def test_what_cannot_be_compared_is_refused(old: str, new: str, said: str, tmp_path: Path) -> None:
    done = run_fingertip("compare", old, new, PWD=str(tmp_path))
    assert done.returncode == 2
    assert said in done.stderr


def test_unknown_revision_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('name = "a"\n')
    subprocess.run(["git", "-C", str(tmp_path), "init", "-q"], check=True)
    for revision in ("v9", "--output=x"):
        done = run_fingertip("compare", "--", revision, "a.toml", PWD=str(tmp_path))
        assert done.returncode == 2
        assert (
            f"OLD: {revision}: is no design file, no folder, no bundled name, and no revision"
            in done.stderr
        )
