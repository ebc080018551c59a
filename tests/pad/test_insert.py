"""Insert on the sensor: its solids, what it does to the pad by finite elements, and the table that trials read."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.skin import insert_jig, mold_insert, sensor_insert, skin
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.joint import INSERT_BASE_MM
from fingertip.design.geometry.solids import union
from fingertip.foundation.errors import DesignError, TraceError
from fingertip.pad import contacts
from fingertip.pad.contacts import find_contacts
from fingertip.pad.fem_contact import PadModel, Patch
from fingertip.pad.fem_mesh import MeshSize
from fingertip.pad.form import PadForm
from fingertip.pad.pose import Pose
from fingertip.pad.survey import survey_pad

DISC, MUSHROOM = "sensor.insert=disc", "sensor.insert=mushroom sensor.insert_height_mm=0.5"
PLAIN = Design()
EVALUATOR = MeshEvaluator(0.005)


def load(changes: str) -> Design:
    return Design.load(changes=changes.split())


@pytest.mark.parametrize("changes", [DISC, MUSHROOM])
def test_insert_takes_its_volume_from_the_silicone_alone(changes: str) -> None:
    design = load(changes)
    (solid,) = sensor_insert(design)
    (stem, height), *caps = design.dimensions.insert.parts
    wanted = math.pi * (stem**2 * (height - INSERT_BASE_MM) + sum(radius**2 * (top - height) for radius, top in caps))
    solids = {
        "insert": solid, "skin": skin(design), "plain": skin(PLAIN), "bone": PARTS["bone"].solid(design),
        "plain bone": PARTS["bone"].solid(PLAIN), "both": union(mold_insert(PLAIN), solid), "held": mold_insert(design),
    }  # fmt: skip
    volume = {name: EVALUATOR.manifold(one).volume() for name, one in solids.items()}
    assert volume["insert"] == pytest.approx(wanted, rel=4e-3)  # circles are polygons
    base = math.pi * stem**2 * INSERT_BASE_MM
    assert volume["plain"] - volume["skin"] == pytest.approx(volume["insert"] + base, rel=4e-3)
    assert volume["held"] == pytest.approx(volume["both"] + base, rel=1e-4)
    assert volume["bone"] == volume["plain bone"]


@pytest.mark.parametrize("changes", [DISC, MUSHROOM])
def test_jig_centres_the_insert_on_the_platform(changes: str) -> None:
    """Pushed towards the base the jig touches the platform, and the insert falls through the middle of its hole."""
    design = load(changes)
    gap, (insert,) = design.sensor.clearance_mm, map(EVALUATOR.manifold, sensor_insert(design))
    jig, bone = EVALUATOR.manifold(insert_jig(design)), EVALUATOR.manifold(PARTS["bone"].solid(design))
    assert (jig ^ bone).volume() < 1e-9
    pushed = jig.translate((0.0, 0.0, -gap))
    assert (pushed ^ bone).volume() < 0.01
    assert (jig.translate((0.0, 0.0, -1.5 * gap)) ^ bone).volume() > 0.01
    for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        assert (pushed.translate((0.8 * gap * x, 0.0, 0.8 * gap * z)) ^ insert).volume() == 0.0
        assert (pushed.translate((1.2 * gap * x, 0.0, 1.2 * gap * z)) ^ insert).volume() > 0.0
    for x in (1, -1):
        assert (jig.translate((1.5 * gap * x, 0.0, 0.0)) ^ bone).volume() > 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (f"{DISC} sensor.insert_height_mm=2.5", "sensor.insert_height_mm: 2.5 mm leaves less .* at most 1.3"),
        (f"{DISC} sensor.insert_diameter_mm=6", "is wider than the sensor's active area; at most"),
        (f"{DISC} mold.method=plunge", "disc needs mold.method=overmold"),
        (f"{DISC} skin.crown_radius_mm=0 bone.platform_mm=0", "needs a platform of at least bone.platform_mm=0.5"),
        (f"{MUSHROOM} sensor.insert_cap_diameter_mm=4", "is narrower than its stem; at least 4.5 mm"),
    ],
)
def test_insert_without_room_is_refused(changes: str, message: str) -> None:
    with pytest.raises(DesignError, match=f"(?s){message}"):
        load(changes)


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch, tmp_path) -> list[float]:
    """Compute tables on a coarse mesh, in a cache of their own, and count the meshes."""
    made, real = [], PadModel.__init__

    def count(self: PadModel, form: PadForm, size: MeshSize, *, is_half: bool) -> None:
        made.append(size.edge_mm)
        real(self, form, MeshSize(1.6), is_half=is_half)

    monkeypatch.setattr(PadModel, "__init__", count)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    contacts._read_table.cache_clear()
    return made


@pytest.mark.full
def test_table_is_computed_once_for_a_form_and_read_again(coarse: list[float], tmp_path) -> None:
    form = PadForm.of_design(load(DISC))
    first = find_contacts(form, Pose(7.0, 5.0), (0.5, 1.0))
    assert len(coarse) == 2
    contacts._read_table.cache_clear()
    assert [c.share for c in find_contacts(form, Pose(7.0, 5.0), (0.5, 1.0))] == [c.share for c in first]
    assert len(coarse) == 2
    (file,) = (tmp_path / "fingertip" / "pads").iterdir()
    for number, damaged in enumerate(("{", "[]", '{"straight": 1}'), start=1):
        file.write_text(damaged)
        contacts._read_table.cache_clear()
        assert find_contacts(form, Pose(7.0), (1.0,))[0].share > 0.8
        assert len(coarse) == 2 + 2 * number, "a damaged file is computed again"


def test_poses_beyond_the_table_are_refused() -> None:
    form = PadForm.of_design(load(DISC))
    for pose in (Pose(-6.0), Pose(21.0), Pose(5.0, 21.0), Pose(5.0, 0.0, "edge")):
        with pytest.raises(TraceError, match="known with an insert"):
            find_contacts(form, pose, (1.0,))


@pytest.mark.full
@pytest.mark.parametrize(("changes", "least", "wide", "far"), [(DISC, 0.80, 0.60, 0.30), (MUSHROOM, 0.80, 0.60, 0.30)])
def test_fsr400_with_an_insert_feels_as_asked_for(changes: str, least: float, wide: float, far: float) -> None:
    """By finite elements at 1 N, and the table beside them between its poses."""
    form = PadForm.of_design(load(changes))
    model = PadModel(form, MeshSize(), is_half=True)
    tilts = (-5.0, -3.0, 0.0, 2.0, 5.0, 7.0, 10.0, 12.5, 15.0, 20.0)
    patches = {tilt: Patch(model, Pose(tilt)) for tilt in tilts}
    light, share = {}, {}
    for tilt, patch in patches.items():
        light[tilt], share[tilt] = patch.press(0.25).share, patch.press(1.0).share
    grasp = [share[tilt] for tilt in tilts if 0.0 <= tilt <= 10.0]
    assert min(grasp) >= least
    assert min(share[tilt] for tilt in tilts if tilt <= 15.0) >= wide
    assert share[20.0] >= far
    assert min(grasp) / max(grasp) >= 0.90
    assert form.turn_on_n / min(light[tilt] for tilt in tilts if tilt <= 15.0) <= 0.30
    table = [find_contacts(form, Pose(tilt), (1.0,))[0].share for tilt in tilts]
    assert table == pytest.approx(list(share.values()), abs=0.01)
    assert survey_pad(load(changes)).rolled_share > 0.5


@pytest.mark.full
def test_a_soft_insert_is_silicone(monkeypatch: pytest.MonkeyPatch) -> None:
    """An insert of the silicone's modulus changes nothing but the mesh."""
    form = PadForm.of_design(load(DISC))
    monkeypatch.setattr("fingertip.pad.fem_contact.PLASTIC_MPA", form.young_mpa)
    monkeypatch.setattr("fingertip.pad.fem_contact.PLASTIC_POISSON", form.poisson)
    one, other = (
        Patch(PadModel(each, MeshSize(), is_half=True), Pose(5.0)).press(1.0)
        for each in (form, replace(form, insert=None))
    )
    assert one.share == pytest.approx(other.share, abs=5e-3)
    assert one.depth_mm == pytest.approx(other.depth_mm, rel=0.03)
    assert np.isfinite(one.area_mm2)
