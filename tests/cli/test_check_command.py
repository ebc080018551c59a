"""`fingertip check`, `fingertip params` and `fingertip picture`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.verification import check
from fingertip.cli.check_reports import Finding
from fingertip.models.solids import Box
from tests.conftest import design_file, run_fingertip

FSR400 = design_file("fsr400")
FSR402 = design_file("fsr402")
COARSE = ("--tolerance-mm", "0.05")


@pytest.mark.full
def test_valid_designs_exit_0(tmp_path: Path) -> None:
    report = tmp_path / "reports" / "check.xml"
    done = run_fingertip(
        "check",
        FSR400,
        FSR402,
        *COARSE,
        "--junit",
        report,
        "--json",
        "--quiet",
        "--margins",
        PWD=str(tmp_path),
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    output = json.loads(done.stdout)
    assert output["passed"] is True
    assert [design["design"] for design in output["designs"]] == ["fsr400", "fsr402"]
    for one in output["designs"]:
        margins = [margin["margin_percent"] for margin in one["margins"]]
        assert len(margins) == 10
        assert margins == sorted(margins)
        assert margins[0] >= 0
    written = [case.get("name") for case in ElementTree.parse(report).iter("testcase")]
    assert written == [check["name"] for design in output["designs"] for check in design["checks"]]
    assert {"bone.stl.genus", "demolding_overlap.mold_palmar", "overlap.skin.core"} <= set(written)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["check.xml"], (
        "nothing is exported"
    )


def test_any_mesh_is_checked_and_another_file_is_told_what_check_takes(tmp_path: Path) -> None:
    halves = [Box((0.0, 0.0, 0.0), (9.0, 4.0, 9.0)), Box((0.0, -4.0, 0.0), (9.0, 0.0, 9.0))]
    meshes = [MeshEvaluator(0.1).mesh(half) for half in halves]
    for name, mesh in zip(("mold_dorsal", "mold_palmar"), meshes, strict=True):
        (tmp_path / f"{name}.stl").write_bytes(stl.to_bytes(mesh, name))
    done = run_fingertip("check", tmp_path / "mold_dorsal.stl", "--verbose")
    assert done.returncode == 0, done.stderr
    assert "all 11 checks passed" in done.stdout
    assert "mold_palmar.pull_overlap" in done.stdout
    open_mesh = Mesh(meshes[0].vertices, meshes[0].triangles[1:])
    (tmp_path / "open.stl").write_bytes(stl.to_bytes(open_mesh, "open"))
    deeper = MeshEvaluator(0.1).mesh(Box((0.0, -4.0, 0.0), (9.0, 1.0, 9.0)))
    (tmp_path / "mold_palmar.stl").write_bytes(stl.to_bytes(deeper, "deeper"))
    done = run_fingertip("check", tmp_path / "open.stl", tmp_path / "mold_dorsal.stl", "--json")
    assert done.returncode == 1
    failed = {
        c["name"]
        for mesh in json.loads(done.stdout)["meshes"]
        for c in mesh["checks"]
        if not c["passed"]
    }
    assert failed >= {"open_edges", "mesh.trimesh.open", "mold_palmar.overlap"}
    (tmp_path / "cut.stl").write_bytes(b"no mesh")
    (tmp_path / "part.step").write_bytes(b"\xff")
    for name, said in (
        ("cut.stl", "cannot be read as a mesh"),
        ("part.step", "is not a design; check takes design files"),
    ):
        done = run_fingertip("check", tmp_path / name)
        assert done.returncode == 2
        assert said in done.stderr


@pytest.mark.second
def test_failed_checks_exit_1_and_appear_in_every_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # With a negative limit every check of a zero volume fails, but no check of topology.
    monkeypatch.setattr(check, "VOLUME_TOLERANCE_MM3", -1.0)
    report = tmp_path / "check.xml"
    arguments = ("check", FSR400, *COARSE, "--junit", report)
    done = run_fingertip(*arguments)
    assert done.returncode == 1, done.stderr
    rows = [line for line in done.stdout.splitlines() if line.endswith("FAILED")]
    failed = {line.split()[0] for line in rows}
    assert len({len(re.findall(r"^\S+ +\S+", line)[0]) for line in rows}) == 1, (
        "values end below each other"
    )
    assert "demolding_overlap.mold_dorsal" in failed
    assert "bone.stl.genus" not in failed
    assert done.stdout.endswith("try --tolerance-mm 0.01 first.\n")
    root = ElementTree.parse(report).getroot()
    assert {
        case.get("name") for case in root.iter("testcase") if case.find("failure") is not None
    } == failed
    assert root.get("failures") == str(len(failed))
    output = json.loads(run_fingertip(*arguments, "--json").stdout)
    assert output["passed"] is False
    assert {c["name"] for c in output["designs"][0]["checks"] if not c["passed"]} == failed


def test_of_many_designs_the_valid_ones_are_checked_and_each_refusal_has_its_line(
    tmp_path: Path,
) -> None:
    (tmp_path / "bad.toml").write_text(
        'name = "bad"\n[skin]\nwidth_mm = 99 # too wide\n[bone]\nmaterial = "x"\n'
    )
    (tmp_path / "empty.toml").write_text("# nothing\n")
    (tmp_path / "twice.toml").write_text("[skin]\n[bone]\n[skin]\n")
    reports = ("--junit", "r.xml", "--sarif", "r.sarif")
    words = ("check", "bad.toml", "empty.toml", "twice.toml", FSR400, *COARSE, "-q", *reports)
    done = run_fingertip(*words, "--json", PWD=str(tmp_path), GITHUB_ACTIONS="true")
    assert done.returncode == 2
    found = json.loads(done.stdout)
    assert [one["design"] for one in found["designs"]] == ["fsr400"]
    assert found["designs"][0]["passed"]
    lines = {(one["file"], one["line"], one["field"], one["value"]) for one in found["issues"]}
    assert lines == {
        ("bad.toml", 3, "skin.width_mm", 99),
        ("bad.toml", 5, "bone.material", "x"),
        ("empty.toml", None, "empty.toml", None),
        ("twice.toml", 3, "twice.toml", None),
    }
    root = ElementTree.parse(tmp_path / "r.xml").getroot()
    assert (root.get("errors"), root.get("failures")) == ("4", "0")
    assert {
        case.get("name") for case in root.iter("testcase") if case.find("error") is not None
    } == {field for _, _, field, _ in lines}
    results = json.loads((tmp_path / "r.sarif").read_text())["runs"][0]["results"]
    assert len(results) == 4
    assert "::error file=bad.toml,line=3,title=skin.width_mm::99 mm is too large" in done.stderr
    escaped = Finding("f.toml", None, "a:b,c", "1 %,\nor: 2").to_annotation()
    assert escaped == "::error file=f.toml,title=a%3Ab%2Cc::1 %25,%0Aor: 2", (
        "as GitHub reads workflow commands"
    )
    assert "error: empty.toml: sets no parameter" in done.stderr


@pytest.mark.full
def test_designs_of_the_same_name_are_labelled_by_their_files(tmp_path: Path) -> None:
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).write_text('name = "tip"')
    done = run_fingertip(
        "check", "a.toml", "b.toml", "a.toml", *COARSE, "--json", "-q", PWD=str(tmp_path)
    )
    assert [design["design"] for design in json.loads(done.stdout)["designs"]] == [
        "a.toml",
        "b.toml",
    ]
