"""Mold of a cup and a core, and its checks: values against closed
forms, and each check with its defect.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import assembly, trapped_air
from fingertip.cad.verification import mold as checks
from fingertip.cad.verification.check import Solids
from fingertip.design import Design
from fingertip.design.geometry.casting_layout import POURED
from fingertip.foundation.errors import DesignError
from fingertip.models import making, mold
from fingertip.models.core import core_within_skin
from fingertip.models.making import making_of
from fingertip.models.parts import parts_by_name
from fingertip.models.skin import skin
from fingertip.models.solids import Box, Solid, cylinder
from tests.cad.part_checks import TOLERANCE

EVALUATOR = MeshEvaluator(TOLERANCE)
FINGER = Design.load("first_finger")
THICK = "silicone.product=own silicone.viscosity_pa_s={}"


def find_failed(design: Design) -> list[str]:
    solids = Solids.of(design, EVALUATOR, parts_by_name(design))
    return [check.name for check in checks.check_mold(design, solids) if not check.passed]


def failed(*changes: str) -> set[str]:
    return {*find_failed(Design.load("first_finger", changes=" ".join(changes).split()))}


def test_first_finger_passes_with_figures_near_those_of_the_study() -> None:
    assert not failed()
    assert checks.palmar_error_mm(FINGER) == pytest.approx(0.14, abs=0.005)
    longer = FINGER.with_values({"skin.length_mm": 33.0})
    assert checks.palmar_error_mm(longer) < 0.15, "the seat of a longer core is wider"
    for name in ("adult_finger", "fsr402"):
        design = Design.load(name)
        pressure = checks.plunge_pressure_kpa(design, EVALUATOR)
        assert 0.5 < pressure < 4.0
        assert 1.0 <= design.mold_layout.plunge_kpa / pressure < 1.1, (
            "the rule leaves a margin to the solids"
        )


@pytest.mark.parametrize(
    ("changes", "wanted"),
    [
        ("printer.surface_error_mm=0.3", {"mold.palmar_error", "mold.creep"}),
        (f"{THICK.format(120)} silicone.pot_life_min=1", {"mold.seat_film"}),
        ("silicone.product=own silicone.elongation_percent=60", {"skin.fitting_stretch"}),
    ],
)
def test_checks_find_their_defects(changes: str, wanted: set[str]) -> None:
    assert failed(changes) == wanted


def test_core_that_thick_silicone_would_bend_is_refused_and_found() -> None:
    with pytest.raises(
        DesignError, match=r"part the halves of the mold.*\n.*a core that own silicone bends by"
    ):
        Design.load("fsr402", changes=THICK.format(60).split())
    thick = Design.load("fsr402").with_values(
        {"silicone.product": "own", "silicone.viscosity_pa_s": 60.0}
    )
    assert find_failed(thick) == ["mold.plunge_pressure", "mold.core_bending"]


def test_thin_wall_behind_letters_is_found_and_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert failed("mold.wall_mm=1.8") == set()
    with pytest.raises(
        DesignError, match=r"mold\.wall_mm: 1\.7 mm leaves less than .* at least 1\.8 mm"
    ):
        Design.load("first_finger", changes=["mold.wall_mm=1.7"])
    deep = tuple(replace(letter, high=letter.high + 3.0) for letter in mold.label(FINGER))
    monkeypatch.setattr(mold, "label", lambda design: deep)
    assert failed() == {"mold.wall"}


def test_film_on_the_seat_grows_with_the_root_of_the_viscosity() -> None:
    thin, thick = (
        checks.seat_film_mm(Design.load("first_finger", changes=THICK.format(mu).split()))
        for mu in (5, 20)
    )
    assert thick == pytest.approx(2 * thin)


def test_core_and_halves_that_catch_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A core wider than its cavity, and a dorsal half that is pulled off before the core
    is lifted.
    """
    lowered = checks.build_lowered
    barb = Box((-9.3, 0.0, 14.0), (9.3, 1.0, 15.0))
    with monkeypatch.context() as patch:
        patch.setattr(checks, "build_lowered", lambda design: lowered(design).union(barb))
        found = {
            check.name for check in checks._check_motions(FINGER, EVALUATOR) if not check.passed
        }
        assert found == {"mold.lowering_overlap", "mold.lifting_overlap"}
    with monkeypatch.context() as patch:
        patch.setattr(assembly, "LIFT_MM", 0.0)
        solids = Solids.of(FINGER, EVALUATOR, ("core", "skin", *assembly.HALVES))
        found = {
            check.name for check in assembly.check_assembly(FINGER, solids) if not check.passed
        }
        assert found == {"demolding_overlap.mold_dorsal"}, (
            "the third ridge catches unless the core is lifted"
        )


def hang(monkeypatch: pytest.MonkeyPatch, solid: Solid) -> None:
    """Let another solid hang in the silicone."""
    other = replace(making_of(FINGER), in_cup=lambda finger: solid)
    monkeypatch.setitem(making.MAKINGS, "cast", other)


def test_air_in_a_pocket_is_found_whole_and_none_in_the_design(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bore up into the core holds its whole volume; a recess with a
    horizontal roof holds some in one lean only.
    """
    assert checks.worst_air_mm3(FINGER, EVALUATOR) == 0.0
    whole = core_within_skin(FINGER)
    free = EVALUATOR.manifold(mold.cavity(FINGER).cut(whole))
    for lean in trapped_air.LEANS_DEG:
        assert trapped_air._flood_mm3(free, lean) == 0.0, "the flood agrees that there is no summit"
    bore = cylinder("z", (3.0, 1.0), 15.0, 40.0, 1.0)
    held = float((EVALUATOR.manifold(bore) ^ EVALUATOR.manifold(whole)).volume())
    hang(monkeypatch, whole.cut(bore))
    assert checks.worst_air_mm3(FINGER, EVALUATOR) == pytest.approx(held, rel=0.12)
    dims = FINGER.dimensions
    steep = cylinder("y", (dims.sensor_z, 0.0), -20.0, 0.4 - dims.platform_depth, 3.4)
    hang(monkeypatch, whole.cut(steep))
    assert checks.worst_air_mm3(FINGER, EVALUATOR) > 0.0


def test_palmar_error_is_the_worst_of_all_signs_and_a_common_error_only_lifts() -> None:
    flanks = FINGER.mold_layout.flanks
    dims = FINGER.dimensions
    rows = [[*normal, *np.cross(point, normal)] for point, normal in flanks]
    sensor = np.array((0.0, -dims.platform_depth, dims.sensor_z))
    shifts = []
    for signs in product((-0.05, 0.05), repeat=6):
        motion = np.linalg.solve(rows, signs)
        shifts.append((motion[:3] + np.cross(motion[3:], sensor))[1])
    assert len(shifts) == 64
    assert max(map(abs, shifts)) == pytest.approx(checks.palmar_error_mm(FINGER))
    lifted = np.linalg.solve(rows, np.full(6, 0.1))
    assert lifted == pytest.approx([0.0, 0.0, -0.1 * math.sqrt(2.0), 0.0, 0.0, 0.0], abs=1e-12)


def test_seam_fills_to_the_depth_of_creeping_flow() -> None:
    """x = h sqrt(integral of p / (6 mu)): twice the gap of 0.1 mm is
    filled twice as deep, over twice the gap.
    """
    wide = FINGER.with_values({"printer.surface_error_mm": 2 * FINGER.printer.surface_error_mm})
    assert checks.seam_mm3(wide, 1.5) == pytest.approx(4 * checks.seam_mm3(FINGER, 1.5))
    silicone = FINGER.silicone.material
    length = FINGER.skin.length_mm
    head = silicone.density_g_cm3.high * 9.81 * length * 60 * silicone.planned_pot_life_min
    lowering = 1500 * making_of(FINGER).lowering_s / silicone.viscosity_pa_s.high
    integral = head / silicone.viscosity_pa_s.low + lowering
    seam = 2 * FINGER.mold_layout.cavity_half_width + 4 / 3 * length
    assert checks.seam_mm3(FINGER, 1.5) == pytest.approx(0.1**2 * math.sqrt(integral / 6) * seam)


def test_pressure_between_cylinders_is_that_of_an_annular_gap() -> None:
    """Between cylinders of radii 5 and 6 mm the slot formula is near
    the exact one for an annulus (Bird, 2.4).
    """
    outer, core = (
        EVALUATOR.manifold(cylinder("z", (0.0, 0.0), -1.0, 9.0, radius)) for radius in (6.0, 5.0)
    )
    gaps, lengths, area = checks._measure_gap_around(outer, core, 4.0)
    assert area == pytest.approx(25 * math.pi, rel=0.01)
    assert (gaps**3 * lengths).sum() == pytest.approx(2 * math.pi * 5.0, rel=0.02)


def test_silicone_stands_where_pictures_show_it_before_the_core_is_lowered() -> None:
    exact = EVALUATOR.manifold(skin(FINGER)).volume() * FINGER.dimensions.shrinkage**3
    below = EVALUATOR.manifold(mold.cavity(FINGER)).trim_by_plane(
        (0.0, 0.0, 1.0), FINGER.mold_layout.pour_z
    )
    assert below.volume() == pytest.approx(POURED * exact, rel=0.03)
