"""CadQuery scripts of parts: the same solids, run alone, and
parameters from which everything follows.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fingertip
from fingertip import Design, build
from fingertip.cad.files.cadquery_script import write_functions, write_script
from fingertip.cad.files.named_numbers import Named, Term, wrap
from fingertip.cad.files.script_text import Text
from fingertip.cad.files.trace import Trace, name_letters
from fingertip.cad.kernel.mesh import MeshEvaluator, to_arrays
from fingertip.cad.shapes.engraving import STROKE_WIDTH, letter_outlines
from fingertip.cad.shapes.parts import PARTS, parts_by_name, shapes_of_parameters
from fingertip.design.geometry import solids
from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.profile import Tip
from fingertip.design.parameters import PARAMETERS
from tests.conftest import ROOT, run_python

NAMES = ("bone", "skin", "mold_palmar", "mold_dorsal", "core", "stand")
MODULES = ("cq_numbers.py", "cq_outlines.py", "cq_parameters.py", "cq_solids.py")
ALONE = """
import runpy, sys
sys.modules["fingertip"] = None  # importing it would fail
sys.path.insert(0, sys.argv[1])
def show(shown, name):
    print(name)
    if name != "finger":
        assert all(shown.faces(tag=tag).workplane() for tag in shown.ctx.tags)
        shown.val().exportBrep(f"{sys.argv[1]}/{name}.brep")
for path in sys.argv[2:]:
    runpy.run_path(f"{sys.argv[1]}/{path}", init_globals={"show_object": show})
"""
SHARE = 0.02
NOISE = 1e-6
BESIDE = 1e-9
"""Largest difference from a change that is true, of a change; noise of
a mesh; and relative difference of numbers.
"""


class Part:
    """What a script makes where its primitives are those of the program, in place of a
    workplane.
    """

    def __init__(self, *made: solids.Solid) -> None:
        self.made = made
        self.val = lambda: self
        (self.solid, *_) = made

    def cut(self, tools: Part, clean: bool) -> Part:
        return Part(solids.Difference(self.solid, tools.made))

    def union(self, others: Part, clean: bool = True) -> Part:
        return Part(solids.Union((self.solid, *others.made)))

    def intersect(self, other: Part, clean: bool) -> Part:
        return Part(solids.Intersection((self.solid, other.solid)))

    def solids(self) -> Part:
        return self

    def tag(self, name: str) -> None:
        assert name

    def faces(self, selected: Any) -> Part:
        return self


def to_tuple(value: Any) -> Any:
    return tuple(map(to_tuple, value)) if isinstance(value, tuple | list) else value


def superconic(section: Any, spans: Any) -> Part:
    z = spans[-1].z[2]
    scale = spans[-1].scale[2]
    tip = None
    stations = [(span.z[0], span.scale[0]) for span in spans]
    if scale:
        stations.append((z, scale))
    else:
        tip = Tip(z, spans[-1].weight)
    body = ConicBody(CrossSection(*section), tuple(stations), tip)
    body.__dict__["spans"] = tuple(spans)
    return Part(solids.SuperconicSolid(body))


PRIMITIVES = {
    "box": solids.Box,
    "cylinder": solids.cylinder,
    "cone": solids.Cone,
    "prism": solids.Prism,
    "elbow_tube": solids.ElbowTube,
}


@cache
def functions() -> Mapping[str, Any]:
    """Run the functions of the scripts, without cadquery, whose primitives are replaced."""
    names: dict[str, Any] = {"__name__": "cq_numbers"}
    for text in write_functions(Design()).values():
        exec(re.sub(r"(?m)^(from OCP|from cq_|import cadquery).*", "", text.decode()), names)
    made = {
        name: lambda *a, make=make: Part(make(*map(to_tuple, a)))
        for name, make in PRIMITIVES.items()
    }
    names |= (
        made | {name.capitalize(): each for name, each in made.items()} | {"superconic": superconic}
    )
    names |= {"stack": lambda *parts: Part(*(part.solid for part in parts)), "in_plane": float}
    names["scaled"] = lambda part, by: Part(solids.Scaled(part.solid, by))
    return names


def run_script(text: str, part: str, **changed: float) -> solids.Solid:
    for name, value in changed.items():
        text, count = re.subn(rf"(?m)^{name} = \S+", f"{name} = {value!r}", text)
        assert count == 1
    names = dict(functions()) | {"__name__": "__main__"}
    names |= {
        name_letters(each): letter_outlines(each, STROKE_WIDTH)
        for each in re.findall(r"letters_(\w+)", text)
    }
    kept = re.sub(
        r"(?s)import cadquery as cq\n|from cq_\w+ import (\(.*?\)|\w+(, \w+)*)\n", "", text
    )
    exec(kept.partition("\nif show")[0], names)
    made: Part = names[part]
    return made.solid


def numbers(value: Any) -> Iterator[float | str]:
    """List all numbers of a solid, with the kinds of what it consists of."""
    match value:
        case solids.Intersection((solids.Intersection(inner), *others)):
            yield from numbers(solids.Intersection((*inner, *others)))
        case solids.Union(made) | solids.Intersection(made):
            yield from (type(value).__name__, *(each for one in made for each in numbers(one)))
        case solids.Difference(first, cut):
            yield from ("cut", *numbers(first), *(each for one in cut for each in numbers(one)))
        case solids.Scaled(inner, factor):
            yield from (*numbers(inner), factor)
        case tuple() | list():
            for each in value:
                yield from numbers(each)
        case float() | int() | str():
            yield value
        case _:
            yield from numbers(solids.call_of(value))


def moments(solid: solids.Solid) -> Any:
    """Compute volume, centre and second moments [mm3, mm, mm5] of a solid's mesh."""
    vertices, triangles = to_arrays(MeshEvaluator(0.1).manifold(solid))
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = a + b + c
    second = sum(np.einsum("n,ni,nj->ij", volumes / 20.0, each, each) for each in (a, b, c, total))
    centre = (volumes[:, None] * total).sum(axis=0) / (4.0 * volumes.sum())
    return np.array([volumes.sum(), *centre, *second[np.triu_indices(3)]])


def find_wrong(
    design: Design, part: str, wanted: int | None = None
) -> tuple[list[str], int, list[str], list[str]]:
    """Change parameters of a script by 3 %; return what is wrong, the
    count of all, what it refuses, what it lacks.
    """
    text = write_script(design, part).decode()
    whole = PARTS[part].solid(design)
    section = text.partition("# Parameters")[2].partition("# Fixed for")[0]
    stated = {name: float(value) for name, value in re.findall(r"(?m)^(\w+) = (\S+)", section)}
    paths = {path.replace(".", "_"): path for path, declared in PARAMETERS.items()}
    chosen = [(name, by) for name, value in stated.items() if value for by in (1.03, 0.97)]
    wrong = []
    refused = []
    before = moments(whole) if wanted else None
    for name, by in random.Random(7).sample(chosen, wanted) if wanted else chosen:
        value = stated[name] * by
        sensor = design.dimensions.sensor
        changes = (
            {paths[name]: value}
            if name in paths
            else {
                "sensor.model": "custom",
                **{
                    f"custom_sensor.{key}": getattr(sensor, key)
                    * (by if name == f"sensor_{key}" else 1.0)
                    for key in type(design.custom_sensor).model_fields
                },
            }
        )
        try:
            true = PARTS[part].solid(design.with_values(changes))
        except ValueError:  # beyond its bounds, such as a fullness above 1
            continue
        try:
            made = run_script(text, part, **{name: value})
        except SystemExit as error:
            refused.append(f"{name} {error}")
            continue
        pairs = list(zip(numbers(made), numbers(true), strict=False))
        is_same = len(list(numbers(made))) == len(list(numbers(true))) and all(
            a == b or (not isinstance(a, str) and abs(a - float(b)) <= BESIDE * max(1.0, abs(a)))
            for a, b in pairs
        )
        if is_same and before is None:
            continue
        before = moments(whole) if before is None else before
        scale = np.array([before[0], *[10.0] * 3, *[before[4:].max()] * 6])
        found = moments(made)
        expected = moments(true)
        if (abs(found - expected) > SHARE * abs(expected - before) + NOISE * scale).any():
            wrong.append(f"{part}: {name} = {value}")
    return (
        wrong,
        len(chosen),
        refused,
        [] if wanted else list(find_missing(design, part, set(stated))),
    )


def find_missing(design: Design, part: str, stated: set[str]) -> Iterator[str]:
    """Find parameters of a design that change a part and do not stand in its script."""
    before = list(numbers(PARTS[part].solid(design)))
    for path, names in shapes_of_parameters(design).items():
        value = design.value(path)
        is_missing = (
            part in names and isinstance(value, float) and path.replace(".", "_") not in stated
        )
        if (
            is_missing
            and list(numbers(PARTS[part].solid(design.with_values({path: value * 1.03})))) != before
        ):
            yield path


@pytest.mark.parametrize("part", ["bone", "skin", "mold_dorsal"])
def test_six_parameters_change_the_solid_as_in_the_program(part: str) -> None:
    wrong, _, refused, _ = find_wrong(Design(), part, 2)
    assert not wrong
    assert not refused


DESIGNS = {
    "post": ("fsr400", ()),
    "clevis": ("adult_finger", ()),
    "flange": ("fsr400", ("bone.interface=flange",)),
    "socket": ("fsr400", ("bone.interface=socket",)),
    "straight": ("fsr400", ("skin.crown_radius_mm=0",)),
    "inset": ("fsr400", ("mold.core_inset_mm=0.2", "printer.offset_mm=0.1")),
}
OTHERS = [
    path.stem
    for path in (ROOT / "params").glob("*.toml")
    if path.stem not in ("fsr400", "adult_finger")
]


def check_all(design: Design) -> None:
    counts = 0
    refusals = list[str]()
    shares = list[float]()
    for part in parts_by_name(design):
        wrong, count, refused, missing = find_wrong(design, part)
        assert not wrong
        counts = counts + count
        refusals = refusals + refused
        shares.append(count / (count + 2 * len(missing)))
    assert len(refusals) <= 0.05 * counts, refusals
    assert min(shares) >= 0.85, shares


@pytest.mark.full
@pytest.mark.parametrize("name", DESIGNS)
def test_every_parameter_changes_the_solid_as_in_the_program(name: str) -> None:
    preset, changes = DESIGNS[name]
    tables = Design.load(preset)
    values = dict(change.split("=") for change in changes)
    check_all(
        tables.with_values({path: float(v) if v[0].isdigit() else v for path, v in values.items()})
    )


@pytest.mark.full
@pytest.mark.long
@pytest.mark.parametrize("name", OTHERS)
def test_every_parameter_of_every_preset_follows(name: str) -> None:
    check_all(Design.load(name))


@pytest.mark.full
def test_wrong_number_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    true = write_script

    def spoiled(design: Design, part: str) -> bytes:
        return true(design, part).replace(
            b"skin_semi_axis_palmar_mm * shrinkage", b"7.4 * shrinkage"
        )

    monkeypatch.setitem(find_wrong.__globals__, "write_script", spoiled)
    assert len(find_wrong(Design(), "mold_palmar")[0]) >= 2


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scripts")
    made = build(Design(), folder, formats=["cq"], tolerance_mm=0.05)
    assert [dict(part.files) for part in made.parts] == [{"cq": f"{name}.cq.py"} for name in NAMES]
    assert made.report()["parts"]["bone"]["sha256"]["cq"]
    return folder


def test_scripts_name_what_they_make(scripts: Path) -> None:
    text = (scripts / "bone.cq.py").read_text()
    for line in (
        "bone_channel_diameter_mm = 2.8  # Diameter of the hole for both wires",
        "tail_half_width = sensor_tail_width_mm / 2 + sensor_clearance_mm  # Half the width of "
        "the tail's slot",
        "# Cable channel: from the floor of the trough by one bend to the dorsal side of the "
        "base\ncable_channel = ",
    ):
        assert f"\n{line}" in text
    stated = re.findall(
        r"(?m)^# (\w+)$|^(\w+?)_\w+ = ",
        text.partition("# Parameters")[2].partition("# Fixed for")[0],
    )
    tables = dict.fromkeys(table.capitalize() for _, table in stated if table)
    assert [heading for heading, _ in stated if heading] == list(tables), (
        "one heading above each table's parameters"
    )
    assert not run_python(
        "-m", "ruff", "check", "-q", "--isolated", "--select", "F", str(scripts)
    ).stdout
    texts = {path.name: path.read_text() for path in scripts.glob("*.py")}
    assert set(texts) == {*(f"{name}.cq.py" for name in (*NAMES, "sensor", "finger")), *MODULES}
    for each in texts.values():
        assert max(map(len, each.splitlines())) <= 120
        assert len(each.splitlines()) <= 350
        assert not re.search("(import|from) fingertip", each)
    assert write_script(Design(), "bone") == text.encode()
    assert (
        text.index("\nbody = ")
        < text.index("\n# Below base\nbelow_base_size = ")
        < text.index("\nbelow_base = ")
    )


def test_refused_number_ends_with_its_condition_and_remedy() -> None:
    text = write_script(Design(), "bone").decode()
    assert "around the bone that retains the skin [above 0 to 1.826]\n" in text
    with pytest.raises(fingertip.FingertipError, match=r"1\.827 mm cuts"):
        [Design.load(changes={"bone.groove_depth_mm": value}) for value in (1.826, 1.827)]
    for changes, wanted in (
        (
            {"bone_groove_depth_mm": 0},
            r"_depth_mm is not 0.0; .* --formats cq --set bone\.groove_depth_mm=0$",
        ),
        (
            {"bone_rim_mm": 0.1, "bone_wall_mm": 12, "skin_width_mm": "18"},
            r"^bone_rim_mm = 0\.1 is no number within 0\.2 to 5\nbone_wall_mm = 12 .* "
            r"5\nskin_width_mm = '18' .* 60$",
        ),
        (
            {"bone_channel_diameter_mm": 9.0},
            r"whose bone_\w+ > channel_radius; .*\.channel_diameter_mm=9\.0$",
        ),
        (
            {"sensor_tail_width_mm": 20.0},
            r"--set sensor\.model=custom( --set custom_sensor\.\w+=[0-9.]+){4}$",
        ),
        ({"skin_crown_radius_mm": 99}, r"^skin_crown_radius_mm = 99: lay_crown has no result; "),
        ({"ALONG_FLOOR_MM": 1.0}, "no parameter ALONG_FLOOR_MM"),
    ):
        with pytest.raises(SystemExit, match=wanted):
            run_script(f"CHANGES = {changes}\n{text}", "bone")


def test_named_numbers_keep_their_brackets() -> None:
    text = Text(Trace(Design(), PARTS["skin"].solid), "skin")
    a, b = (wrap(value, Term("name", name)) for name, value in {"a": 3.0, "b": 0.5}.items())
    for number in (
        a - (b - a),
        a - (2 - -b),
        (a + b) * -a,
        a / (b * a),
        a / b / a,
        -(a + b),
        -a * b,
        (-2) ** (a - 1),
    ):
        assert isinstance(number, Named)
        assert eval(text.write(number.term)[0], {}, {"a": 3.0, "b": 0.5}) == number
    assert [a + 0, 1 * a, a * 0] == [a, a, 0.0]


@pytest.mark.full
def test_scripts_run_alone_give_the_solids_of_the_step_files(scripts: Path) -> None:
    import cadquery

    finger = (scripts / "finger.cq.py").read_text()
    (scripts / "wider.cq.py").write_text(
        finger.replace("CHANGES = {}", 'CHANGES = {"bone_channel_diameter_mm": 3.0}')
    )
    (scripts / "wrong.cq.py").write_text(
        finger.replace("CHANGES = {}", 'CHANGES = {"nothing": 3.0}')
    )
    assert (
        "there is no parameter nothing"
        in run_python("-c", ALONE, str(scripts), "wrong.cq.py").stderr
    )
    done = run_python("-c", ALONE, str(scripts), "finger.cq.py")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [*NAMES, "sensor", "finger"]
    for name in NAMES:
        wanted = fingertip.part_solid(Design(), name)
        made = cadquery.Shape.importBrep(str(scripts / f"{name}.brep"))
        assert made.Volume() == pytest.approx(wanted.Volume(), rel=1e-9)
        assert made.Center().toTuple() == pytest.approx(wanted.Center().toTuple(), abs=1e-6)
        assert len(made.Faces()) == len(wanted.Faces())
        assert made.ShapeType() == "Solid"
    assert run_python("-c", ALONE, str(scripts), "wider.cq.py").returncode == 0
    made = cadquery.Shape.importBrep(str(scripts / "bone.brep"))
    changed = fingertip.part_solid(Design.load(changes={"bone.channel_diameter_mm": 3.0}), "bone")
    assert made.Volume() == pytest.approx(changed.Volume(), rel=1e-9)
