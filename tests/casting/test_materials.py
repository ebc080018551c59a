"""Silicones: every property has a source or is marked as unverified. Quantities to mix follow in closed form."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.casting.materials import MATERIALS, SOURCES, MaterialProperty, Silicone, find_silicone
from fingertip.casting.quantities import MIN_COMPONENT_G, WASTE_FRACTION, compute_batch, mass_g, split_by_mix_ratio
from fingertip.errors import DesignError


@pytest.mark.parametrize("silicone", MATERIALS.values(), ids=MATERIALS)
class TestEachSilicone:
    def test_every_property_has_a_source_or_is_marked_as_unverified(self, silicone: Silicone) -> None:
        assert len(silicone.properties()) == 9
        for name, value in silicone.properties().items():
            assert value.source in SOURCES, name
            assert value.source not in ("", "common") or not value.verified, f"{name} has no source and no mark"
            assert 0.0 < value.low <= value.high, name

    def test_properties_are_those_of_a_40_shore_a_silicone(self, silicone: Silicone) -> None:
        assert 35.0 <= silicone.shore_a.low <= silicone.shore_a.high <= 45.0
        assert 0.7 <= silicone.modulus_mpa.low <= silicone.modulus_mpa.high <= 2.0
        assert 1.0 < silicone.density_g_cm3.low <= silicone.density_g_cm3.high < 1.3
        assert silicone.parts_a.low / silicone.parts_b.low == 10.0

    def test_mass_is_volume_times_density(self, silicone: Silicone) -> None:
        assert mass_g(silicone, 2.5) == pytest.approx(2.5 * silicone.density_g_cm3.high, rel=1e-15)

    def test_components_sum_to_the_total_in_the_mix_ratio(self, silicone: Silicone) -> None:
        a, b = split_by_mix_ratio(silicone, 33.0)
        assert a + b == pytest.approx(33.0, rel=1e-15)
        assert a / b == pytest.approx(10.0, rel=1e-14)

    def test_batch_is_the_mold_content_plus_waste(self, silicone: Silicone) -> None:
        batch = compute_batch(silicone, 40.0)
        assert batch.in_mold_g == pytest.approx(40.0 * silicone.density_g_cm3.high)
        assert batch.total_g == batch.with_waste_g == pytest.approx((1 + WASTE_FRACTION) * batch.in_mold_g)
        assert batch.waste_g == pytest.approx(WASTE_FRACTION * batch.in_mold_g)
        assert batch.a_g + batch.b_g == pytest.approx(batch.total_g)

    def test_small_batch_is_large_enough_to_weigh(self, silicone: Silicone) -> None:
        batch = compute_batch(silicone, 1.0)
        assert batch.with_waste_g == pytest.approx((1 + WASTE_FRACTION) * silicone.density_g_cm3.high)
        assert batch.b_g == pytest.approx(MIN_COMPONENT_G)
        assert batch.a_g == pytest.approx(10.0 * MIN_COMPONENT_G)
        assert batch.waste_g == pytest.approx(batch.total_g - silicone.density_g_cm3.high)


def test_addition_cure_silicone_shrinks_least() -> None:
    shrinkage = {name: silicone.shrinkage_percent.high for name, silicone in MATERIALS.items()}
    assert shrinkage["addition_40a"] == 0.2
    assert shrinkage["condensation_40a"] == 1.2


def test_upper_end_of_the_modulus_follows_ruess_relation() -> None:
    """Ruess: lg E = 0.0235 S - 0.6403, for 30 to 60 Shore A (josephborrello.com/shore-a-to-modulus)."""
    modulus_mpa = 10.0 ** (0.0235 * 40.0 - 0.6403)
    assert modulus_mpa == pytest.approx(1.994, abs=1e-3)
    assert MATERIALS["addition_40a"].modulus_mpa.high == pytest.approx(modulus_mpa, abs=0.01)


def test_batch_follows_another_mix_ratio() -> None:
    part = MaterialProperty(1, 1, "neat")
    equal_parts = replace(MATERIALS["addition_40a"], parts_a=part, parts_b=part)
    assert split_by_mix_ratio(equal_parts, 10.0) == (5.0, 5.0)
    assert compute_batch(equal_parts, 0.01).a_g == pytest.approx(MIN_COMPONENT_G)


def test_unverified_property_is_printed_with_a_mark() -> None:
    assert str(MaterialProperty(5.0, 40.0, "neat")) == "5 to 40"
    assert str(MaterialProperty(1.08, 1.08, "", verified=False)) == "1.08 (unverified)"


def test_unknown_silicone_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(DesignError, match=r"--material: there is no 'sylgard'; did you mean sylgard_184\?"):
        find_silicone("sylgard")
