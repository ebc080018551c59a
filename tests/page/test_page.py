"""Page of a design as a file: whole, alone, the same each time, and with everything that it should show."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from fingertip import Design
from fingertip.cad.files import stl
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.catalogues.output_files import PAGE
from fingertip.design.files import format_value, list_parameters
from fingertip.foundation.errors import OutputError
from fingertip.page import MAX_BYTES
from fingertip.page.parameters_and_checks import render_verdict
from fingertip.page.render import ARTICLE_DOI, render_page
from fingertip.page.sources import read_sources
from fingertip.slip.traces.truth import BAND_LABEL, format_delay_band
from fingertip.tasks.page import write_page
from tests.conftest import ROOT, run_fingertip, some_of
from tests.page.conftest import DRAWING, Page


@pytest.mark.full
def test_is_well_formed_small_and_refers_to_itself_alone(page: Page, folder: Path) -> None:
    assert not page.faults
    ids = list(page.attributes("id"))
    assert len(ids) == len(set(ids))
    assert find_missing_targets(page) == set()
    assert 1_000_000 < (folder / PAGE).stat().st_size < MAX_BYTES
    text = page.source.replace(page.scripts[1], "")
    assert str(folder) not in text
    assert not re.search(r"/(tmp|home|root)/|\b20\d\d-\d\d-\d\d\b", text)


def find_missing_targets(page: Page) -> set[str]:
    """Names of elements that a link or a label refers to and that are not there."""
    wanted = {link[1:] for link in page.attributes("href") if link.startswith("#")}
    wanted |= {name for key in ("for", "aria-labelledby") for value in page.attributes(key) for name in value.split()}
    assert len(wanted) > 50
    return wanted - set(page.attributes("id"))


@pytest.mark.full
def test_asks_nothing_of_the_network(page: Page) -> None:
    """The only addresses are the article's, which is text to follow, and a name of HTML's namespace in three.js."""
    addresses = set(re.findall(r"(?:https?:)?//[a-z0-9-]+(?:\.[a-z0-9-]+)+[^\s\"'`<>)]*", page.source))
    assert {address for address in addresses if address.startswith("http")} == {
        f"https://doi.org/{ARTICLE_DOI}", "http://www.w3.org/1999/xhtml",
    }  # fmt: skip
    for key in ("src", "data", "action", "poster", "srcset", "background"):
        assert all(value.startswith("data:") for value in page.attributes(key))
    assert all(value.startswith(("#", "https://doi.org/")) for value in page.attributes("href"))
    assert not {"link", "iframe", "object", "embed", "base", "form"} & {tag for tag, _ in page.elements}
    assert "url(" not in page.source.split("</style>")[0]


@pytest.mark.full
def test_policy_allows_this_content_alone(page: Page) -> None:
    (policy,) = (a["content"] for _, a in page.elements if a.get("http-equiv") == "Content-Security-Policy")
    assert policy
    rules = {rule.split()[0]: rule.split()[1:] for rule in policy.split("; ")}
    assert rules["default-src"] == ["'none'"]
    assert rules["img-src"] == ["data:", "blob:"]
    style = page.source.partition("<style>")[2].partition("</style>")[0]
    for key, texts in (("script-src", page.scripts[1:]), ("style-src", [style])):
        hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts]
        assert rules[key] == [f"'sha256-{found}'" for found in hashes]
    # Whatever needs an exception from the policy is not there.
    assert not list(page.attributes("style"))
    assert not [key for _, attributes in page.elements for key in attributes if key.startswith("on")]


@pytest.mark.full
def test_command_gives_the_bytes_of_another_process(folder: Path) -> None:
    before = (folder / PAGE).read_bytes()
    (folder / PAGE).unlink()
    done = run_fingertip("page", "fsr400", "--out", folder, "--json")
    assert done.returncode == 0
    data = json.loads(done.stdout)
    assert (folder / PAGE).read_bytes() == before
    assert data == {"page": str(folder / PAGE), "bytes": len(before), "remarks": []}
    assert run_fingertip("check", folder).returncode == 0


@pytest.mark.full
def test_states_every_check_with_value_and_limit(page: Page, folder: Path) -> None:
    report = json.loads((folder / "report.json").read_bytes())
    assert len(report["checks"]) > 80
    signs = {"at most": "≤", "at least": "≥", "exactly": "="}
    for check in report["checks"]:
        assert check["name"] in page.text
        limit = f"{signs[check['relation']]} {check['limit']:.4g} {check['unit']}".rstrip()
        assert f"{check['name']}{check['value']:.4g} {check['unit']}".rstrip() + limit in page.text, check
    assert f"{len(report['checks']) - 2} of {len(report['checks'])} checks of the parts passed, 2 warn" in page.text
    warned = [check for check in report["checks"] if check["state"] == "warning"]
    assert len(warned) == 2
    assert all(f"{check['name']}: {check['warning']}" in page.text for check in warned)
    held = report | {"checks": [check for check in report["checks"] if check["state"] == "passed"]}
    assert f"All {len(held['checks'])} checks of the parts passed" in str(render_verdict(held))


@pytest.mark.full
def test_states_every_parameter_with_unit_bounds_and_meaning(page: Page, design: Design) -> None:
    for parameter in list_parameters():
        value = f"{format_value(design.value(parameter.path))} {parameter.unit}".rstrip()
        assert f"{parameter.path}{parameter.description}" in page.text
        row = page.text.partition(f"{parameter.path}{parameter.description}")[2][:400]
        assert value in row
        assert parameter.bounds in row
        assert f"p-{parameter.path}" in set(page.attributes("id"))


@pytest.mark.full
def test_a_failed_check_comes_first_and_names_the_parameters(folder: Path, design: Design) -> None:
    sources = read_sources(design, folder)
    check = next(check for check in sources.report["checks"] if check["name"] == "mold.fill_time")
    check |= {"passed": False, "value": 999.0}
    failed = Page(render_page(sources).decode())
    assert f"✗ 1 of {len(sources.report['checks'])} checks failed" in failed.text
    table = failed.text.partition("Failed")[2][:300]
    assert "mold.fill_time999 s" in table
    assert "mold.nozzle_bore_mm" in table


@pytest.mark.full
def test_meshes_are_those_of_the_files(page: Page, folder: Path, design: Design) -> None:
    parts = {item["name"]: item for item in page.scene if not item["bought"]}
    assert set(parts) == set(parts_by_name(design))
    for name, item in parts.items():
        mesh = stl.from_bytes((folder / f"{name}.stl").read_bytes())
        vertices = np.frombuffer(base64.b64decode(item["vertices"]), "<f4").reshape(-1, 3)
        kind = "<u4" if item["wide"] else "<u2"
        triangles = np.frombuffer(base64.b64decode(item["triangles"]), kind).reshape(-1, 3)
        assert np.array_equal(vertices, mesh.vertices)
        assert np.array_equal(triangles, mesh.triangles)
    screws = (f"mold_{kind}_{i}" for i in range(1, 5) for kind in ("bolt", "nut"))
    assert [item["name"] for item in page.scene if item["bought"]] == ["sensor", *screws, "chaplet_screw"]


@pytest.mark.full
def test_every_step_has_its_text_and_its_picture(page: Page, folder: Path) -> None:
    steps = re.findall(r"^\d+\. (.*)\n\n   !\[step (\d+)\]\((.*)\)$", (folder / "casting.md").read_text(), re.MULTILINE)
    assert len(steps) > 20
    pictures = [a["src"] for tag, a in page.elements if tag == "img" and (a["alt"] or "").startswith("step ")]
    assert len(pictures) == len(steps)
    for (text, _, path), picture in zip(steps, pictures, strict=True):
        assert text.replace("`", "").replace("**", "") in page.text
        assert picture == "data:image/png;base64," + base64.b64encode((folder / path).read_bytes()).decode()


@pytest.mark.full
def test_shows_the_drawing_and_the_board(page: Page, folder: Path) -> None:
    drawing = f"data:image/svg+xml;base64,{base64.b64encode(DRAWING).decode()}"
    assert drawing in set(page.attributes("src"))
    for line in (folder / "board" / "bom.csv").read_text().splitlines()[1:]:
        references = line.split(",")[1]
        assert references in page.text
    for part_number in ("CL31B105KBHNNNE", "AD623ARMZ"):
        assert part_number in page.text
    assert "tp1_open_v" in page.text  # bring-up
    assert "TP1" in page.text


@pytest.mark.full
def test_states_the_delay_of_the_detection_and_what_encoders_know(page: Page, folder: Path) -> None:
    detection = json.loads((folder / "signal" / "detection.json").read_bytes())
    (delay,) = detection["delays_s"]
    assert f"{1000 * delay:.1f} ms" in page.text
    low, high = (1000 * volts for volts in detection["threshold_range_v"])
    used = f"threshold {low:.3g} to {high:.3g} mV, {1000 * detection['threshold_v']:.3g} at the first ON"
    assert f"Detector fast, on voltage_v and filtered_v, statistic of fast: {used}" in page.text
    assert "threshold of analog and digital" in page.text  # the header's is of another quantity
    assert "detector threshold" not in page.text

    (since_motion,) = detection["delays_since_motion_s"]
    assert BAND_LABEL in page.text
    assert f"{1000 * since_motion:.1f} ms after the robot moved ({format_delay_band(since_motion)}" in page.text
    for said in ("What is simulated and what is measured", "Nobody has printed and cast", "a real finger will differ"):
        assert said in page.text


@pytest.fixture
def copy(folder: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(folder, tmp_path / "copy"))


@pytest.mark.full
def test_missing_and_changed_parts_are_refused_all_at_once(copy: Path, design: Design) -> None:
    (copy / "bone.stl").unlink()
    (copy / "skin.stl").write_bytes((copy / "skin.stl").read_bytes()[:-50])
    with pytest.raises(OutputError) as caught:
        write_page(design, copy)
    said = {Path(issue.field).name: issue.message for issue in caught.value.issues}
    assert set(said) == {"bone.stl", "skin.stl"}
    assert "is missing" in said["bone.stl"]
    assert "was changed" in said["skin.stl"]
    assert all("fingertip make" in message for message in said.values())


@pytest.mark.full
def test_parts_of_other_parameters_are_refused(copy: Path) -> None:
    other = Design.load("fsr400", changes=["detector.threshold_v=0.02"])
    with pytest.raises(OutputError, match="other parameters; fingertip make DESIGN makes them again"):
        write_page(other, copy)
    done = run_fingertip("page", "fsr400", "--set", "detector.threshold_v=0.02", "--out", copy)
    assert done.returncode == 2


def test_an_empty_folder_is_refused_with_the_command(tmp_path: Path) -> None:
    done = run_fingertip("page", "fsr400", "--out", tmp_path / "none")
    assert done.returncode == 2
    assert "holds no parts of 'fsr400'; fingertip make DESIGN makes them." in done.stderr
    assert not (tmp_path / "none").exists()


@pytest.mark.full
def test_what_else_is_missing_or_old_is_said_on_the_page(copy: Path, design: Design) -> None:
    shutil.rmtree(copy / "board")
    trace = copy / "signal" / "trace.csv"
    trace.write_text(trace.read_text().replace("4.4", "4.5"))
    manifest = json.loads((copy / "steps" / "manifest.json").read_bytes())
    (copy / "steps" / "manifest.json").write_text(json.dumps(manifest | {"parameters": "other"}))
    _, _, remarks = write_page(design, copy)
    other, changed = "were made from other parameters", "were changed after they were written"
    remedy = "in the folder of the page, fingertip"
    assert remarks == (
        f"The files in steps/ {other}; {remedy} build design.toml --out . --pictures makes them.",
        f"The files in board/ are missing; {remedy} board design.toml --out board --bringup makes them.",
        f"The files in signal/ {changed}; {remedy} make design.toml --out . --force makes them.",
    )
    page = Page((copy / PAGE).read_text())
    assert not page.faults
    assert all(remark in page.text for remark in remarks)
    assert find_missing_targets(page) == set()


@pytest.mark.full
def test_the_command_on_the_page_makes_what_is_missing(copy: Path, design: Design) -> None:
    shutil.rmtree(copy / "board")
    _, _, (remark,) = write_page(design, copy)
    words = remark.partition("fingertip ")[2].removesuffix(" makes them.").split()
    assert run_fingertip(*words, PWD=str(copy)).returncode == 0
    assert write_page(design, copy)[2] == ()


def test_the_library_is_the_version_that_the_tool_states() -> None:
    stated = json.loads((ROOT / "tools/page_libraries/package.json").read_bytes())["dependencies"]["three"]
    bundle = (ROOT / "src/fingertip/page/assets/three.bundle.js").read_text()
    assert f'"{stated.split(".")[1]}"' in bundle
    assert "three.js authors" in (ROOT / "src/fingertip/page/assets/three.LICENSE").read_text()


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(("fsr402", "child_thumb", "adult_finger"), "child_thumb"))
def test_other_designs_have_pages_too(name: str, tmp_path: Path) -> None:
    """A folded tail, a lid, a joint; and a skin pulled over."""
    changes = ["mold.method=sleeve"] if name == "fsr402" else []
    options = [option for change in changes for option in ("--set", change)]
    assert run_fingertip("build", name, *options, "--out", tmp_path, "--formats", "stl", "--pictures").returncode == 0
    done = run_fingertip("page", name, *options, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    page = Page((tmp_path / PAGE).read_text())
    assert not page.faults
    assert len(page.source) < MAX_BYTES
    items = {item["name"]: item for item in page.scene}
    assert ("core" in items) == bool(changes)
    places = [tuple(a + b for a, b in zip(i["opened"], i["apart"], strict=True)) for i in page.scene if not i["bought"]]
    assert len(set(places)) == len(places), "taken apart, two parts lie in one place"
