"""Checks of all parts together: which are made, their causes, and
builds of every option, of some parts or formats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import MIN_TOLERANCE_MM, MeshEvaluator
from fingertip.cad.verification import verify as checks
from fingertip.cad.verification.check import Check, Solids
from fingertip.cad.verification.verify import CHECKS, list_causes, verify
from fingertip.cli.check_tables import describe_cause
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.foundation.errors import DesignError, FingertipError
from fingertip.tasks.build import build
from tests.conftest import run_python, some_of

TOLERANCE = 0.05


@pytest.mark.parametrize(
    ("change", "failed"),
    [
        (lambda triangles: triangles, set()),
        (lambda triangles: triangles[1:], {"skin.stl.open_edges"}),
        (lambda triangles: triangles[:, ::-1], {"skin.stl.inverted"}),
    ],
)
def test_writer_that_loses_a_triangle_or_inverts_the_mesh_fails(
    change: Callable[[object], object], failed: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write = stl.to_bytes
    monkeypatch.setattr(
        stl,
        "to_bytes",
        lambda mesh, *words: write(replace(mesh, triangles=change(mesh.triangles)), *words),
    )
    found = verify(Design(), ["skin"], ["stl", "3mf", "step"], MeshEvaluator(TOLERANCE))
    names = {check.name for check in found.checks if not check.passed}
    assert failed <= names if failed else not names
    assert set(found.contents) == {"skin.stl", "skin.3mf"}, "STEP is made elsewhere"


@pytest.mark.parametrize("tolerance", [0.0, MIN_TOLERANCE_MM / 2, 1.1, float("nan"), -0.01])
def test_tolerance_out_of_bounds_is_rejected(tolerance: float) -> None:
    with pytest.raises(
        DesignError, match=r"tolerance_mm: .* out of bounds; choose 0\.0005 to 1 mm"
    ):
        MeshEvaluator(tolerance)


def test_report_names_what_to_change() -> None:
    change = list_causes("mold.creep")
    assert change[0] == "printer.surface_error_mm"
    assert Check("mold.creep", 200.0, 150.0, "mm3", change=change).to_dict()["change"] == list(
        change
    )
    assert "change" not in Check("mold.creep", 20.0, 150.0, "mm3", change=change).to_dict()
    assert list_causes("bone.stl.open_edges") == list_causes("unknown") == ()
    assert {name for one in CHECKS for change in one.change.values() for name in change} <= set(
        PARAMETERS
    )


@pytest.mark.parametrize("name", ["bone.colour", "skin.min_thickness"])
def test_check_of_another_package_joins_the_others_under_a_name_of_its_own(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def call(group: str, design: Design, solids: Solids) -> Iterator[Check]:
        assert group == "fingertip.checks"
        yield Check(
            name, solids["skin"].volume(), 0.0, "mm3", change=("skin.width_mm",), source="mine"
        )

    monkeypatch.setattr(checks, "call_plugins", call)
    solids = Solids.of(Design(), MeshEvaluator(TOLERANCE), ["skin"])
    if name == "bone.colour":
        *_, last = checks.run_checks(Design(), solids)
        assert describe_cause(last) == "change skin.width_mm"
        assert describe_cause(replace(last, change=())) == "this is a bug in mine"
    else:
        with pytest.raises(FingertipError, match="no Check with a name of its own"):
            list(checks.run_checks(Design(), solids))


def test_only_the_requested_parts_are_built(tmp_path: Path) -> None:
    result = build(Design(), tmp_path, parts=["bone"], formats=["stl"], verify=True)
    assert result.report()["trimesh"].keys() == {"bone.stl"}
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"bone.stl", "design.toml", "manifest.json", "print", "report.json"}
    assert {path.name for path in (tmp_path / "print").iterdir()} == {"bone.stl", "manifest.json"}
    assert [built.part.name for built in result.parts] == ["bone"]


def find_open(contents: object, meshes: object) -> tuple[Check, ...]:
    return (Check("skin.stl.trimesh.open", 1.0, 0, "", "exactly"),)


def test_what_trimesh_finds_wrong_fails_a_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fingertip.tasks.build.second_opinions", find_open)
    result = build(Design(), tmp_path, parts=["skin"], formats=["stl"], verify=True)
    assert [check.name for check in result.checks if not check.passed] == ["skin.stl.trimesh.open"]


def test_importing_fingertip_imports_no_heavy_package() -> None:
    done = run_python(
        "-c", "import fingertip, sys; print(len({'numpy','pydantic','typer'} & set(sys.modules)))"
    )
    assert done.stdout.strip() == "0", done.stderr


UNLIMITED = ["strength.min_grip_factor=0", "strength.min_knock_factor=0"]
VARIANTS = {
    "socket": ["bone.interface=socket", "bone.base_length_mm=31", "strength.print_material=clear"],
    "round post": ["bone.post_width_mm=7", "bone.post_height_mm=7", *UNLIMITED],
    "flange with four bolts": [
        "bone.interface=flange",
        "bone.base_length_mm=27",
        "bone.flange_spacing_y_mm=12",
        "bone.flange_height_mm=18",
        "strength.print_material=pa12",
    ],
    "short tail": ["sensor.model=fsr400_short", "bone.base_length_mm=15"],
    "plain": [
        "bone.groove_depth_mm=0",
        "mold.engraving_depth_mm=0",
        "mold.silicone_shrinkage_percent=0",
    ],
    "custom sensor": [
        "sensor.model=custom",
        "custom_sensor.head_diameter_mm=6",
        "custom_sensor.length_mm=36",
    ],
    "compensated": ["printer.scale_percent=100.4", "name=A_very-long_name_with-forty_characters_1"],
}


@pytest.mark.full
@pytest.mark.parametrize(
    "name", some_of(VARIANTS, "flange with four bolts", "short tail", "custom sensor")
)
def test_variant_builds_and_passes_all_checks(name: str, tmp_path: Path) -> None:
    result = build(
        Design.load(changes=VARIANTS[name]), tmp_path, formats=["stl", "step"], tolerance_mm=0.02
    )
    assert [check for check in result.checks if not check.passed] == []
    assert any(check.name.endswith("step.genus") for check in result.checks)
