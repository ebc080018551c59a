"""CadQuery scripts: without the program, the same parts follow from parameters.py."""

from __future__ import annotations

import ast
import hashlib
import json
import random
import re
import shutil
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

import fingertip
from fingertip import Design, build
from fingertip.cad.files import cadquery_scripts
from fingertip.cad.files.cadquery_scripts import write_models, write_parameters, write_scripts
from fingertip.catalogues.output_files import MODELS_FOLDER
from fingertip.design.geometry import DesignTables
from fingertip.models import finger
from fingertip.models.hardware import hardware
from fingertip.models.parts import parts_by_name
from tests.conftest import ROOT, run_python
from tools import examples

DESIGNS = sorted(path.stem for path in (ROOT / "params").glob("*.toml"))
INTERFACES = ("socket", "flange", "clevis")
SOLIDS_ALONE = """
import hashlib, json, sys
sys.modules["fingertip"] = None  # importing it would fail
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from runpy import run_path
from fingertip_models.finger import Finger, ParameterError
from fingertip_models.hardware import hardware
from fingertip_models.parts import parts_by_name

def describe(finger):
    solids = {name: part.solid(finger) for name, part in parts_by_name(finger).items()}
    solids |= {item.name: item.solid for item in hardware(finger, solids)}
    return {name: hashlib.sha256(repr(each).encode()).hexdigest() for name, each in solids.items()}

found = {}
for case in json.loads(Path(sys.argv[2]).read_text()):
    names = run_path(str(Path(sys.argv[1]) / f"{case['design']}.py"))
    tables = {name: names[name] for name in json.loads(sys.argv[3])}
    for path, value in case["changes"].items():
        table, _, key = path.partition(".")
        setattr(tables[table], key, value)
    try:
        found[case["name"]] = describe(Finger(names["name"], **tables))
    except Exception as error:
        found[case["name"]] = type(error).__name__
print(json.dumps(found))
"""
SCRIPTS_ALONE = """
import runpy, sys
sys.modules["fingertip"] = None
shown = []
def show(workplane, name):
    shown.append(name)
    if name != "finger":
        assert all(workplane.faces(tag=tag).vals() for tag in workplane.ctx.tags)
        print(name, *workplane.ctx.tags)
        workplane.val().exportBrep(f"{sys.argv[1]}/{name}.brep")
runpy.run_path(f"{sys.argv[1]}/{sys.argv[2]}", init_globals={"show_object": show})
"""
Case = dict[str, Any]


def describe(design: DesignTables) -> dict[str, str] | str:
    """Hash the solid of each part and bought item of a design, or name the error."""
    try:
        solids = {name: part.solid(design) for name, part in parts_by_name(design).items()}
        solids |= {item.name: item.solid for item in hardware(design, solids)}
    except Exception as error:
        return type(error).__name__
    return {
        name: hashlib.sha256(repr(solid).encode()).hexdigest() for name, solid in solids.items()
    }


def list_cases(name: str) -> list[Case]:
    """List each number of a design changed by 3 %, or from 0 by 3 % of its bounds, each choice of
    another word, and each interface with numbers of its own changed.
    """
    design = Design.load(name)
    changes: list[dict[str, Any]] = []
    for path, field in cadquery_scripts._list_fields():
        value = design.value(path)
        if cadquery_scripts._is_number(field):
            low, high = cadquery_scripts._ends(field)
            step = 0.03 * (value or high - low)
            changes += [
                {path: each} for each in (value + step, value - step) if low <= each <= high
            ]
        else:
            changes += [{path: each} for each in cadquery_scripts._choices(field)]
    for interface in INTERFACES:
        for path in ("bone.foot_radius_mm", "bone.wall_mm", "hand.travel_deg", "hand.width_mm"):
            changes += [{"bone.interface": interface, path: design.value(path) * 1.03}]
    return [{"design": name, "name": f"{name} {each}", "changes": each} for each in changes]


def find_different(cases: list[Case], folder: Path) -> list[str]:
    """Build the solids of all cases by the copied package alone; list those that differ."""
    expected = {}
    for name in {case["design"] for case in cases}:
        (folder / f"{name}.py").write_bytes(write_parameters(Design.load(name)))
    for case in cases:
        expected[case["name"]] = describe(Design.load(case["design"]).with_values(case["changes"]))
    write_all({f"{MODELS_FOLDER}/{name}": data for name, data in write_models().items()}, folder)
    (folder / "cases.json").write_text(json.dumps(cases))
    tables = json.dumps(cadquery_scripts._TABLES)
    done = run_python("-c", SOLIDS_ALONE, str(folder), str(folder / "cases.json"), tables)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found.keys() == expected.keys()
    assert sum(isinstance(each, dict) for each in expected.values()) > 0.9 * len(expected)
    return [name for name in expected if found[name] != expected[name]]


def write_all(files: Mapping[str, bytes], folder: Path) -> None:
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)


@pytest.fixture
def no_ranges(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Leave out the search for ranges, which takes seconds."""
    write_parameters.cache_clear()
    monkeypatch.setattr(cadquery_scripts, "find_bands", lambda *_: ((0.0, 1.0),))
    yield
    write_parameters.cache_clear()


@pytest.mark.usefixtures("no_ranges")
def test_package_alone_makes_the_solids_of_the_program(tmp_path: Path) -> None:
    cases = [{"design": name, "name": name, "changes": {}} for name in DESIGNS]
    changed = [case for name in ("fsr400", "adult_finger") for case in list_cases(name)]
    cases += random.Random(3).sample(changed, 40)
    assert not find_different(cases, tmp_path)


@pytest.mark.full
@pytest.mark.usefixtures("no_ranges")
@pytest.mark.parametrize("name", DESIGNS)
def test_every_number_and_choice_gives_the_solids_of_the_program(name: str, tmp_path: Path) -> None:
    assert not find_different(list_cases(name), tmp_path)


WRONG = (
    ("width_mm=17.0", "width_mm=99", "skin.width_mm = 99 is no number within 6 to 60."),
    ("width_mm=17.0", "width_mm=True", "skin.width_mm = True is no number within 6 to 60."),
    ("width_mm=17.0", "width_mm=float('nan')", "skin.width_mm = nan is no number within 6 to 60."),
    ('"post"', '"file"', "'file' is none of 'post', 'socket', 'flange', 'clevis'."),
    (
        "    rim_mm",
        "    rimm",
        "there is no parameter bone.rimm; did you mean bone.rim_mm?\nbone.rim_mm is missing.",
    ),
    ("    rim_mm=0.6,", "", "bone.rim_mm is missing."),
    ('"fsr400"  #', '"a b"  #', "name = 'a b' needs 1 to 40 letters, digits, - and _."),
)


@pytest.mark.usefixtures("no_ranges")
def test_wrong_parameters_end_in_sentences(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_all(write_copy(Design(), ("bone",)), tmp_path)
    monkeypatch.setitem(sys.modules, "fingertip_models", fingertip.models)
    monkeypatch.setitem(sys.modules, "fingertip_models.finger", finger)
    monkeypatch.setattr(finger, "_CATALOGUE", tmp_path / MODELS_FOLDER / "catalogue.json")
    path = tmp_path / "parameters.py"
    text = path.read_text()
    assert finger.read_finger(tmp_path, "__main__").skin.width_mm == 17.0
    for old, new, sentence in WRONG:
        assert old in text
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(SystemExit, match=f"{re.escape(sentence)}$"):
            finger.read_finger(tmp_path, "__main__")
        with pytest.raises(finger.ParameterError, match=f"{re.escape(sentence)}$"):
            finger.read_finger(tmp_path, "bone")


@pytest.mark.full
@pytest.mark.usefixtures("no_ranges")
def test_what_a_script_cannot_make_ends_in_a_sentence(tmp_path: Path) -> None:
    """A socket has no stand, and a channel that folds into itself no solid."""
    write_all(write_copy(Design(), ("bone", "stand")), tmp_path)
    path = tmp_path / "parameters.py"
    text = path.read_text()
    for part, old, new, sentence in (
        ("bone", "width_mm=17.0", "width_mm=99", "skin.width_mm = 99 is no number within 6 to 60."),
        ("bone", "_diameter_mm=2.8", "_diameter_mm=8", "bone: these parameters give no solid; "),
        ("stand", '"post"', '"socket"', "this finger has no stand; it has bone, skin, "),
    ):
        path.write_text(text.replace(old, new, 1))
        done = run_python(str(tmp_path / f"{part}.cq.py"), PYTHONPATH="")
        assert done.returncode == 1
        assert sentence in done.stderr.splitlines()[-1]


def write_copy(design: Design, parts: tuple[str, ...]) -> dict[str, bytes]:
    """Write scripts with the copy of the models beside them."""
    models = {f"{MODELS_FOLDER}/{name}": data for name, data in write_models().items()}
    return write_scripts(design, parts) | models


def test_copy_of_the_models_is_the_package_itself() -> None:
    package = Path(fingertip.models.__file__).parent
    copied = write_models()
    assert set(copied) == {*(path.name for path in package.glob("*.py")), "catalogue.json"}
    assert all(
        (package / name).read_bytes() == copied[name] for name in copied.keys() - {"catalogue.json"}
    )


@pytest.mark.full
def test_ranges_are_where_the_rules_end() -> None:
    text = write_parameters(Design()).decode().replace("\n    # ", " ")
    stated = re.findall(r"\[(0 or )?([-0-9.]+) to ([-0-9.]+)[^\]]*\]\n    (\w+)=", text)
    ends = {key: (float(low), float(high)) for _, low, high, key in stated}
    low, high = ends["groove_depth_mm"]
    assert low == 0.0
    Design.load(changes={"bone.groove_depth_mm": high})
    with pytest.raises(fingertip.FingertipError, match=r"bone\.groove_depth_mm"):
        Design.load(changes={"bone.groove_depth_mm": high + 0.01})
    assert ends["bed_x_mm"][1] == 2000.0
    assert "crown_radius_mm" in {key for apart, _, _, key in stated if apart}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scripts")
    made = build(Design(), folder, formats=["cq"], tolerance_mm=0.05)
    assert [dict(part.files) for part in made.parts] == [
        {"cq": f"{name}.cq.py"} for name in parts_by_name(Design())
    ]
    assert made.report()["parts"]["bone"]["sha256"]["cq"]
    return folder


@pytest.mark.full
@pytest.mark.parametrize(
    ("change", "changes"),
    [
        (("", ""), {}),
        (("channel_diameter_mm=2.8", "channel_diameter_mm=3.0"), {"bone.channel_diameter_mm": 3.0}),
        (('interface="post"', 'interface="clevis"'), {"bone.interface": "clevis"}),
    ],
)
def test_scripts_run_alone_give_the_solids_of_the_step_files(
    change: tuple[str, str], changes: dict[str, Any], built: Path, tmp_path: Path
) -> None:
    import cadquery

    shutil.copytree(built, tmp_path / "copy")
    folder = tmp_path / "copy"
    parameters = (folder / "parameters.py").read_text()
    (folder / "parameters.py").write_text(parameters.replace(*change))
    done = run_python("-c", SCRIPTS_ALONE, str(folder), "finger.cq.py")
    assert done.returncode == 0, done.stderr
    design: Any = Design().with_values(changes)
    tags = {line.split()[0]: set(line.split()[1:]) for line in done.stdout.splitlines()}
    items = hardware(design, parts_by_name(design))
    assert list(tags) == [*parts_by_name(design), *(item.name for item in items)]
    for name in tags:
        wanted = fingertip.part_solid(design, name)
        made = cadquery.Shape.importBrep(str(folder / f"{name}.brep"))
        assert made.ShapeType() == "Solid"
        assert made.Volume() == pytest.approx(wanted.Volume(), rel=1e-9)
        assert made.Center().toTuple() == pytest.approx(wanted.Center().toTuple(), abs=1e-6)
        assert len(made.clean().Faces()) == len(wanted.clean().Faces())
        assert tags[name] == set(fingertip.part_workplane(design, name).ctx.tags)
    assert {"channel", "flat", "pocket"} < tags["bone"]
    assert tags["skin"] == {"pad"}


@pytest.mark.full
def test_own_features_and_files_of_scripts_run_by_python(built: Path, tmp_path: Path) -> None:
    """A script writes its STEP file, that of the finger all files, with a feature of a part."""
    import cadquery

    folder = tmp_path / "copy"
    shutil.copytree(built, folder)
    bone = (folder / "bone.cq.py").read_text()
    feature = 'bone = bone.cut(cq.Workplane("XY").box(40, 40, 10))\n'
    (folder / "bone.cq.py").write_text(bone.replace("# Add your", f"{feature}# Add your"))
    (folder / "stand.cq.py").unlink()
    done = run_python(str(folder / "finger.cq.py"), PYTHONPATH="", PWD=str(folder))
    assert done.returncode == 0, done.stderr
    made = cadquery.importers.importStep(str(folder / "out/bone.step")).val()
    assert made.Volume() < 0.9 * fingertip.part_solid(Design(), "bone").Volume()
    names = {*parts_by_name(Design()), "sensor"}
    files = {f"{name}.{kind}" for name in names for kind in ("step", "stl")} | {"fsr400.step"}
    assert {path.name for path in (folder / "out").iterdir()} == files
    done = run_python(str(folder / "skin.cq.py"), PYTHONPATH="", PWD=str(folder))
    assert done.stdout == "skin: 17.000 x 15.500 x 34.000 mm\n"
    assert (folder / "skin.step").is_file()


class Renaming(ast.NodeTransformer):
    """Renames local variables of functions, and private functions, of a module."""

    def __init__(self, tree: ast.Module) -> None:
        functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
        self.private = {node.name for node in functions if node.name.startswith("_")}
        self.names: set[str] = set()
        self.count = 0

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        is_outer = not self.names
        if is_outer:
            self.names = find_locals(node)
            if node.name in self.private:
                node.name = self.rename(node.name)
        elif node.name in self.names:
            node.name = self.rename(node.name)
        self.generic_visit(node)
        if is_outer:
            self.names = set()
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id in self.names | self.private:
            node.id = self.rename(node.id)
        return node

    def visit_MatchAs(self, node: ast.MatchAs) -> ast.AST:
        if node.name in self.names:
            node.name = self.rename(node.name)
        return self.generic_visit(node)

    def visit_MatchStar(self, node: ast.MatchStar) -> ast.AST:
        if node.name in self.names:
            node.name = self.rename(node.name)
        return node

    def visit_ExceptHandler(self, node: ast.ExceptHandler) -> ast.AST:
        if node.name in self.names:
            node.name = self.rename(node.name)
        return self.generic_visit(node)

    def rename(self, name: str) -> str:
        self.count += 1
        return f"renamed_{name}_x"


def find_locals(function: ast.FunctionDef) -> set[str]:
    """Find the names that a function binds, but for its arguments and those of inner functions."""
    nodes = [node for node in ast.walk(function) if node is not function]
    bound = {
        node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    bound |= {node.name for node in nodes if isinstance(node, ast.FunctionDef)}
    bound |= {
        node.name
        for node in nodes
        if isinstance(node, ast.MatchAs | ast.MatchStar | ast.ExceptHandler) and node.name
    }
    return bound - {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)} | {""}


MAKE = """
import sys
from fingertip import Design, build
import fingertip
assert fingertip.__file__.startswith(sys.argv[1]), fingertip.__file__
build(Design.load("adult_finger"), sys.argv[2], tolerance_mm=0.05, pictures=True, drawings=True)
"""


@pytest.mark.full
def test_names_of_variables_and_private_functions_change_no_byte(tmp_path: Path) -> None:
    package = Path(fingertip.__file__).parent
    counts = 0
    for name in ("as_it_is", "renamed"):
        shutil.copytree(package, tmp_path / name / "fingertip")
        shutil.copytree(ROOT / "params", tmp_path / name / "fingertip/params")
    for path in (tmp_path / "renamed/fingertip/models").glob("*.py"):
        tree = ast.parse(path.read_text())
        renaming = Renaming(tree)
        path.write_text(ast.unparse(renaming.visit(tree)))
        counts += renaming.count
    assert counts > 1500
    made = []
    for name in ("as_it_is", "renamed"):
        source = str(tmp_path / name)
        done = run_python("-c", MAKE, source, str(tmp_path / f"out_{name}"), PYTHONPATH=source)
        assert done.returncode == 0, done.stderr
        folder = tmp_path / f"out_{name}"
        made.append(
            {
                str(path.relative_to(folder)): path.read_bytes()
                for path in folder.rglob("*")
                if path.is_file() and path.name not in ("manifest.json", "report.json")
            }
        )
    kinds = {Path(name).suffix for name in made[0]}
    assert {".stl", ".3mf", ".step", ".svg", ".pdf", ".png"} <= kinds
    assert made[0] == made[1]


EXAMPLES = examples.FOLDER
RENEW = "run python -m tools.examples"


@pytest.mark.usefixtures("no_ranges")
def test_examples_are_current_but_for_their_ranges() -> None:
    files = examples.list_files()
    stored = {
        str(path.relative_to(EXAMPLES)): path for path in EXAMPLES.rglob("*") if path.is_file()
    }
    assert {name for name in stored if "__pycache__" not in name} == set(files), RENEW
    for name, data in files.items():
        if not name.endswith("parameters.py"):
            assert stored[name].read_bytes() == data, RENEW


@pytest.mark.full
def test_parameters_of_examples_are_current() -> None:
    for name, data in examples.list_files().items():
        assert (EXAMPLES / name).read_bytes() == data, RENEW


@pytest.mark.full
@pytest.mark.parametrize("name", examples.DESIGNS)
def test_examples_run_where_they_lie(name: str, tmp_path: Path) -> None:
    """The scripts find the copy of the models beside their folder."""
    shutil.copytree(EXAMPLES, tmp_path / "cadquery")
    folder = tmp_path / "cadquery" / name
    done = run_python("-c", SCRIPTS_ALONE, str(folder), "finger.cq.py")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") >= 7
