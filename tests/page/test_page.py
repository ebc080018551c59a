"""Page of a design as a file: whole, alone, the same each time,
and with everything that it should show.
"""

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
from fingertip.catalogues.output_files import PAGE
from fingertip.foundation.errors import OutputError
from fingertip.models.parts import parts_by_name
from fingertip.page.page import ARTICLE_DOI
from fingertip.tasks.views import write_page
from tests.conftest import run_fingertip
from tests.page.conftest import Page, make_sources


def test_is_well_formed_and_refers_to_itself_alone(page: Page) -> None:
    assert not page.faults
    ids = list(page.attributes("id"))
    assert len(ids) == len(set(ids))
    assert find_missing_targets(page) == set()


def find_missing_targets(page: Page) -> set[str]:
    """Names of elements that a link or a label refers to and that are not there."""
    wanted = {link[1:] for link in page.attributes("href") if link.startswith("#")}
    wanted |= {
        name
        for key in ("for", "aria-labelledby")
        for value in page.attributes(key)
        for name in value.split()
    }
    assert len(wanted) > 30
    return wanted - set(page.attributes("id"))


def test_asks_nothing_of_the_network(page: Page) -> None:
    """The only addresses are the article's, which is text to follow,
    and a name of HTML's namespace in three.js.
    """
    addresses = set(
        re.findall(r"(?:https?:)?//[a-z0-9-]+(?:\.[a-z0-9-]+)+[^\s\"'`<>)]*", page.source)
    )
    assert {address for address in addresses if address.startswith("http")} == {
        f"https://doi.org/{ARTICLE_DOI}",
        "http://www.w3.org/1999/xhtml",
    }
    for key in ("src", "data", "action", "poster", "srcset", "background"):
        assert all(value.startswith("data:") for value in page.attributes(key))
    outside = {
        value
        for value in page.attributes("href")
        if not value.startswith(("#", "https://doi.org/"))
    }
    sources = make_sources()
    assert outside <= {*sources.files, *sources.unread}, "a link leads to a file of the folder"
    assert {"print/plate_fdm.3mf", "casting.md", "acceptance.md", "board/bom.csv"} <= outside
    assert not {"link", "iframe", "object", "embed", "base", "form"} & {
        tag for tag, _ in page.elements
    }
    assert "url(" not in page.source.split("</style>")[0]


def test_policy_allows_this_content_alone(page: Page) -> None:
    (policy,) = (
        a["content"] for _, a in page.elements if a.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy
    rules = {rule.split()[0]: rule.split()[1:] for rule in policy.split("; ")}
    assert rules["default-src"] == ["'none'"]
    assert rules["img-src"] == ["data:", "blob:"]
    style = page.source.partition("<style>")[2].partition("</style>")[0]
    for key, texts in (("script-src", page.scripts[1:]), ("style-src", [style])):
        hashes = [
            base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts
        ]
        assert rules[key] == [f"'sha256-{found}'" for found in hashes]
    # Whatever needs an exception from the policy is not there.
    assert not list(page.attributes("style"))
    assert not [
        key for _, attributes in page.elements for key in attributes if key.startswith("on")
    ]


def test_meshes_are_those_of_the_files(page: Page, design: Design) -> None:
    files = make_sources().files
    parts = {item["name"]: item for item in page.scene if not item["bought"]}
    assert set(parts) == {name for name, part in parts_by_name(design).items() if not part.is_tool}
    for name, item in parts.items():
        mesh = stl.from_bytes(files[f"{name}.stl"])
        vertices = np.frombuffer(base64.b64decode(item["vertices"]), "<f4").reshape(-1, 3)
        kind = "<u4" if item["wide"] else "<u2"
        triangles = np.frombuffer(base64.b64decode(item["triangles"]), kind).reshape(-1, 3)
        assert np.array_equal(vertices, mesh.vertices)
        assert np.array_equal(triangles, mesh.triangles)
    assert [item["name"] for item in page.scene if item["bought"]] == ["sensor"]


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
    with pytest.raises(
        OutputError, match="other parameters; fingertip make DESIGN makes them again"
    ):
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
    other = "were made from other parameters"
    changed = "were changed after they were written"
    remedy = "in the folder of the page, fingertip"
    assert remarks == (
        f"The files in steps/ {other}; {remedy} build design.toml --out . --pictures makes them.",
        f"The files in board/ are missing; {remedy} board design.toml --out board --bringup makes "
        "them.",
        f"The files in signal/ {changed}; {remedy} make design.toml --out . --force makes them.",
    )
    page = Page((copy / PAGE).read_text())
    assert not page.faults
    assert all(remark in page.text for remark in remarks)
    assert find_missing_targets(page) == set()
    words = remarks[1].partition("fingertip ")[2].removesuffix(" makes them.").split()
    assert run_fingertip(*words, PWD=str(copy)).returncode == 0
    assert write_page(design, copy)[2] == remarks[::2]
