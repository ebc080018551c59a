"""CadQuery scripts of parts: the same solids, run alone, and dimensions that may be changed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import fingertip
from fingertip import Design, build
from fingertip.cad.files.cadquery_script import write_script
from fingertip.cad.files.named_dimensions import Named, Names, literal
from fingertip.design.parameters import PARAMETERS
from tests.conftest import run_python

PARTS = ("bone", "skin", "mold_palmar", "mold_dorsal", "core", "stand")
ALONE = """
import runpy, sys
sys.modules["fingertip"] = None  # importing it would fail
for path in sys.argv[1:]:
    runpy.run_path(path, init_globals={"show_object": lambda solid, name: solid.exportBrep(f"{path}.brep")})
"""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scripts")
    made = build(Design(), folder, formats=["cq"], tolerance_mm=0.05)
    assert [dict(part.files) for part in made.parts] == [{"cq": f"{name}.cq.py"} for name in PARTS]
    assert made.report()["parts"]["bone"]["sha256"]["cq"]
    return folder


def test_scripts_name_what_they_make(scripts: Path) -> None:
    text = (scripts / "bone.cq.py").read_text()
    for line in (
        "bone_channel_diameter_mm = 2.8  # Diameter of the hole for both wires",
        "tail_half_width = sensor_tail_width_mm / 2.0 + sensor_clearance_mm  # mm",
        "sensor_recess = pocket.fuse(flat_slab)",
        "cable_channel = elbow_tube(-flat_depth + pocket_depth, channel_exit_z + bone_channel_bend_radius_mm + 1.0,",
    ):
        assert f"\n{line}" in text
    assert max(map(len, text.splitlines())) <= 120
    head, _, dimensions = text.partition("# Primitives")[0].partition("# Dimensions")
    assert "..." not in dimensions, "comments are whole"
    assert "joint axis of a clevis" in dimensions
    assert "fingertip build design.toml --formats cq" in " ".join(head.split())
    assert "import fingertip" not in text
    assert write_script(Design(), "bone") == text.encode()


@pytest.mark.parametrize("name", ["fsr400", "adult_finger", "fsr402"])
def test_definitions_hold_for_other_parameters(name: str) -> None:
    """A definition that a function of the math module or a choice has a part in would be true by chance."""
    design = Design.load(name)
    numbers = ((path, design.value(path)) for path in PARAMETERS)
    other = Names(
        design.with_values({path: x * (1 + i * 1e-5) for i, (path, x) in enumerate(numbers) if isinstance(x, float)})
    )
    for source in (other.design.dimensions, other.design.mold_layout):
        for key in dir(source):
            getattr(source, key)
    values = {each: defined.value for each, defined in other.definitions.items()}
    for part in PARTS[:-1]:  # the stand is only a post's
        section = write_script(design, part).decode().partition("# Dimensions")[2].partition("# Primitives")[0]
        computed = re.findall(r"(?m)^(\w+) = ([^#\n]*[a-z][^#\n]*)", section)
        assert len(computed) > (1 if part == "core" else 3)
        for each, expression in computed:
            assert eval(expression, {}, values) == pytest.approx(values[each], abs=1e-9), (each, expression)


def test_named_numbers_keep_their_brackets() -> None:
    a, b = Named(3.0, "a"), Named(0.5, "b")
    for number in (a - (b - a), a - (b + 2), (a + b) * -a, a / (b * a), a / b / a, -(a + b), -a * b, 2 - a - -b, 0 - a):
        assert isinstance(number, Named)
        assert eval(number.text, {}, {"a": 3.0, "b": 0.5}) == number
    assert [literal(each) for each in (a + 0, 1 * a, a * 0, a * 0.12345, (a,), "x")] == [
        "a", "a", "0.0", "0.37035", "(a,)", '"x"',
    ]  # fmt: skip


@pytest.mark.full
def test_scripts_run_alone_give_the_solids_of_the_step_files(scripts: Path) -> None:
    import cadquery

    done = run_python("-c", ALONE, *(str(scripts / f"{name}.cq.py") for name in PARTS))
    assert done.returncode == 0, done.stderr
    for name in PARTS:
        wanted, made = fingertip.part_solid(Design(), name), cadquery.Shape.importBrep(f"{scripts / name}.cq.py.brep")
        assert made.Volume() == pytest.approx(wanted.Volume(), abs=1e-6)
        assert made.Center().toTuple() == pytest.approx(wanted.Center().toTuple(), abs=1e-6)
        for axis in "xyz":
            for end in ("min", "max"):
                boxes = wanted.BoundingBox(), made.BoundingBox()
                assert getattr(boxes[0], axis + end) == pytest.approx(getattr(boxes[1], axis + end), abs=1e-6)
        assert wanted.cut(made).Volume() + made.cut(wanted).Volume() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.full
def test_script_follows_a_dimension_that_is_changed(scripts: Path, tmp_path: Path) -> None:
    text = (scripts / "bone.cq.py").read_text()
    (tmp_path / "bone.py").write_text(re.sub(r"(?m)^(bone_channel_diameter_mm) = 2\.8 ", r"\1 = 3.0 ", text))
    done = run_python(str(tmp_path / "bone.py"))
    changed = fingertip.part_solid(Design.load(changes={"bone.channel_diameter_mm": 3.0}), "bone")
    assert done.stdout.startswith("bone: ")
    assert float(done.stdout.split()[-2]) == pytest.approx(changed.Volume(), abs=0.01)
