"""Figures of designs, compared whole with approved ones: sizes, solids, checks, and the
catalogues.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from fnmatch import fnmatchcase
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.settings import FDM, slicer_settings
from fingertip.cad.verification.skin import pull_off_n
from fingertip.casting.mixture import measure_poured_cm3
from fingertip.catalogues import electronics, materials
from fingertip.catalogues.electronics import load_controllers
from fingertip.catalogues.hardware import THREADS
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.models.hardware import hardware
from fingertip.models.mold import cavity
from fingertip.models.parts import parts_by_name
from tests.approved import check_figures
from tests.cad.part_checks import run_all_checks
from tests.conftest import design_file, some_of

APPROVED = Path(__file__).parent / "approved"
CHANGES = {
    "fsr400": "",
    "fsr402": "",
    "adult_finger": "",
    "socket": "bone.interface=socket bone.base_length_mm=28 strength.knock_speed_m_s=0.1 "
    "name=forty_" + 34 * "x",
    "article": "",
}
"""Changes of each design; those without are bundled ones."""


def render(value: object) -> str:
    """Write a value with six digits of each number; of an object, its name and its fields."""
    match value:
        case bool() | None | str():
            return repr(value)
        case float():
            return f"{value:.6g}" if abs(value) > 1e-9 else "0"
        case int():
            return str(value)
        case tuple() | list():
            return f"({', '.join(map(render, value))})"
        case Mapping():
            return f"{{{', '.join(f'{key}: {render(item)}' for key, item in value.items())}}}"
    if dataclasses.is_dataclass(value):
        fields = (
            f"{field.name}={render(getattr(value, field.name))}"
            for field in dataclasses.fields(value)
        )
        return f"{type(value).__name__}({', '.join(fields)})"
    return str(value)


def list_properties(value: object) -> Iterator[str]:
    """Yield a line for each property of an object, in the order of its classes, the base first."""
    members = (item for kind in reversed(type(value).__mro__) for item in vars(kind).items())
    for name, member in members:
        if isinstance(member, (property, cached_property)) and not name.startswith("_"):
            yield f"{name} = {render(getattr(value, name))}"


@cache
def load(name: str) -> Design:
    return Design.load(
        design_file("fsr400" if CHANGES[name] else name), changes=CHANGES[name].split()
    )


def list_sizes(design: Design) -> Iterator[str]:
    yield from list_properties(design.dimensions)
    yield from list_properties(design.mold_layout)
    interface = interface_of(design)
    low_z = -design.dimensions.full_base_length
    yield f"interface {type(interface).__name__}, genus {interface.genus(design)}"
    for z in (0.7 * low_z, low_z + 0.5):
        factors = interface.moment_share(design, z), interface.stress_factors(design, z)
        yield f"at {render(z)}: {render(factors)}"
    yield from (render(stress) for stress in interface.local_stresses(design, 20.0))
    yield from (render(size) for size in interface.sizes(design))
    yield f"pull-off force {render(pull_off_n(design))}"


def list_solids(design: Design) -> Iterator[str]:
    """Volume, area, bounding box and moment of volume of each solid:
    what is moved or mirrored changes the last.
    """
    evaluator = MeshEvaluator(0.05)
    parts = parts_by_name(design)
    solids = {name: part.solid(design) for name, part in parts.items()}
    solids |= {item.name: item.solid for item in hardware(design, list(parts))}
    solids |= {"cavity": cavity(design)}
    for name, solid in solids.items():
        body = evaluator.manifold(solid)
        mesh = evaluator.mesh(solid)
        corners = mesh.vertices[mesh.triangles]
        moment = np.linalg.det(corners) @ corners.sum(axis=1) / 24.0
        moment[abs(moment) < 1e-3] = 0.0  # what remains of two equal halves
        figures = mesh.volume(), mesh.area(), body.bounding_box(), moment.tolist()
        yield f"{name}: genus {body.genus()}, {render(figures)}"
    yield f"poured {render(measure_poured_cm3(design, evaluator))}"
    supports = supports_by_part(design)
    for name, pose in print_orientations(design).items():
        yield (
            f"{name}: {render(pose)}, {slicer_settings(FDM, name, pose, supports[name])}, "
            f"{supports[name].note}"
        )


@pytest.mark.every_case
@pytest.mark.parametrize("name", [name for name in CHANGES if name != "fsr402"])
@pytest.mark.parametrize("list_figures", [list_sizes, list_solids])
def test_figures_of_designs_are_the_approved_ones(
    name: str, list_figures: Callable[[Design], Iterator[str]]
) -> None:
    kind = list_figures.__name__.removeprefix("list_")
    check_figures(APPROVED / f"{name}_{kind}.txt", list_figures(load(name)), 1e-4, 1e-4)


FAULTS = (
    "*.stl.*",
    "*_balance.*",
    "overlap.*",
    "demolding_overlap.*",
    "skin.surface_deviation",
    "mold.*ing_overlap",
)


@pytest.mark.every_case
@pytest.mark.parametrize("name", some_of(sorted(CHANGES), "adult_finger", "fsr400"))
def test_values_of_checks_are_the_approved_ones(name: str) -> None:
    """Each check names the parameters to change, or none where its failure would be a fault of the
    program.

    Those that want an exact value, and have it as they pass, are listed by that value.
    """
    lines = []
    exact = dict[str, list[str]]()
    checks = run_all_checks(load(name))
    assert [check.name for check in checks.values() if not check.passed] == []
    for check in checks.values():
        wanted = f"{check.sign} {render(check.limit)} {check.unit}"
        if check.sign == "=":
            exact.setdefault(f"{check.name.rpartition('.')[2]} {wanted}", []).append(
                check.name.rpartition(".")[0]
            )
        else:
            lines.append(f"{check.name}: {render(check.value)} {wanted}")
        assert bool(check.change) != any(fnmatchcase(check.name, pattern) for pattern in FAULTS), (
            check.name
        )
    lines += (f"{wanted}: {' '.join(files)}" for wanted, files in exact.items())
    check_figures(APPROVED / f"{name}_checks.txt", lines, 1e-3, 1e-3)


def test_catalogues_are_the_approved_ones() -> None:
    """Each figure is entered a second time, from the document that its entry names."""
    entries = [
        *materials.load_silicones().values(),
        *electronics.SENSORS.values(),
        *electronics.AMPLIFIER_CATALOGUE.values(),
        *materials.PRINT_MATERIALS.values(),
        *load_controllers(),
        *THREADS,
    ]
    check_figures(APPROVED / "catalogues.txt", map(render, entries), 0.0, 0.0)
