"""Volume balances of the mold on B-rep solids, without a mesh and with the tolerance of the quadrature only."""

from __future__ import annotations

import pytest

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.assembly import brep_balance_solids, check_brep_assembly
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, cylinder, difference, intersection


class BrepVolumes:
    """Volumes of solids of one design, each evaluated once."""

    def __init__(self, design: Design) -> None:
        from fingertip.cad.kernel import brep

        self.design, self._brep, self._volume = design, brep.BrepEvaluator(), brep.volume
        self.part = {name: part.solid(design) for name, part in parts_by_name(design).items()}

    def __call__(self, solid: Solid) -> float:
        return self._volume(self._brep.shape(solid))


@pytest.fixture(scope="module")
def volume(design: Design) -> BrepVolumes:
    return BrepVolumes(design)


def failed_balances(volume: BrepVolumes, **changed: Solid) -> set[str]:
    """Return the names of the balances that fail when some parts are replaced by other solids."""
    design = volume.design
    parts = {name: BrepMeasurements(volume(changed.get(name, solid)), 0) for name, solid in volume.part.items()}
    volumes = {name: volume(solid) for name, solid in brep_balance_solids(design, parts)}
    return {check.name for check in check_brep_assembly(design, parts, volumes) if not check.passed}


@pytest.mark.full
def test_volume_balances_hold_on_brep_solids(volume: BrepVolumes) -> None:
    assert len(list(brep_balance_solids(volume.design, volume.part))) == 5
    assert failed_balances(volume) == set()


def test_dented_skin_breaks_the_cavity_balance(volume: BrepVolumes) -> None:
    dent = cylinder("y", (8.0, 0.0), 6.3, 20.0, 0.4)
    assert failed_balances(volume, skin=difference(volume.part["skin"], dent)) == {"step.volume_balance.cavity"}


def test_chipped_half_breaks_the_mold_balance(volume: BrepVolumes) -> None:
    chip = Box((15.0, 9.0, 0.0), (30.0, 30.0, 0.1))
    broken = failed_balances(volume, mold_dorsal=difference(volume.part["mold_dorsal"], chip))
    assert broken == {"step.volume_balance.mold"}


def test_only_solids_needed_for_the_built_parts_are_measured(volume: BrepVolumes) -> None:
    assert [name for name, _ in brep_balance_solids(volume.design, ["bone", "skin"])] == [
        "cavity", "core_in_cavity", "boss_in_skin", "boss_in_cavity",
    ]  # fmt: skip
    assert [name for name, _ in brep_balance_solids(volume.design, ["mold_palmar", "mold_dorsal"])] == ["hollow"]
    assert brep_balance_solids(volume.design, ["bone", "mold_palmar"]) == ()


@pytest.mark.full
@pytest.mark.parametrize("pair", [("bone", "mold_palmar"), ("bone", "mold_dorsal"), ("skin", "bone")], ids="-".join)
def test_parts_do_not_overlap(volume: BrepVolumes, pair: tuple[str, str]) -> None:
    assert abs(volume(intersection(*(volume.part[name] for name in pair)))) < 1e-3
