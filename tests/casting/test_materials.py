"""Material cards: every figure has a source or says that it has none; quantities in closed form."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.casting.batches import MIN_PART_G, WASTE_FRACTION, batch, mass_g, split
from fingertip.casting.materials import MATERIALS, SOURCES, MaterialProperty, Silicone, modulus_from_hardness_mpa, silicone
from fingertip.errors import DesignError


@pytest.mark.parametrize("card", MATERIALS.values(), ids=MATERIALS)
class TestEachCard:
    def test_every_figure_has_a_source_or_is_marked(self, card: Silicone) -> None:
        assert len(card.figures()) == 9
        for name, figure in card.figures().items():
            assert figure.source in SOURCES, name
            assert figure.source not in ("", "common") or not figure.verified, f"{name} has no source and no mark"
            assert 0.0 < figure.low <= figure.high, name

    def test_it_is_a_silicone_of_about_40_shore_a(self, card: Silicone) -> None:
        assert 35.0 <= card.shore_a.low <= card.shore_a.high <= 45.0
        assert 0.7 <= card.modulus_mpa.low <= card.modulus_mpa.high <= 2.0
        assert 1.0 < card.density_g_cm3.low <= card.density_g_cm3.high < 1.3
        assert card.parts_a.low / card.parts_b.low == 10.0

    def test_mass_is_volume_times_density(self, card: Silicone) -> None:
        assert mass_g(card, 2.5) == pytest.approx(2.5 * card.density_g_cm3.high, rel=1e-15)

    def test_a_and_b_add_up_in_the_ratio(self, card: Silicone) -> None:
        a, b = split(card, 33.0)
        assert a + b == pytest.approx(33.0, rel=1e-15)
        assert a / b == pytest.approx(10.0, rel=1e-14)

    def test_a_batch_holds_what_fills_the_mold_and_the_waste(self, card: Silicone) -> None:
        mixed = batch(card, 40.0)
        assert mixed.in_mold_g == pytest.approx(40.0 * card.density_g_cm3.high)
        assert mixed.total_g == pytest.approx((1 + WASTE_FRACTION) * mixed.in_mold_g)
        assert mixed.waste_g == pytest.approx(WASTE_FRACTION * mixed.in_mold_g)
        assert mixed.a_g + mixed.b_g == pytest.approx(mixed.total_g)

    def test_a_small_batch_can_still_be_weighed(self, card: Silicone) -> None:
        mixed = batch(card, 1.0)
        assert mixed.b_g == pytest.approx(MIN_PART_G)
        assert mixed.a_g == pytest.approx(10.0 * MIN_PART_G)
        assert mixed.waste_g == pytest.approx(mixed.total_g - card.density_g_cm3.high)


def test_addition_shrinks_least() -> None:
    shrinkage = {name: card.shrinkage_percent.high for name, card in MATERIALS.items()}
    assert shrinkage["addition_40a"] == 0.2
    assert shrinkage["condensation_40a"] == 1.2


def test_ruess_at_40_is_the_upper_end_of_the_modulus() -> None:
    assert modulus_from_hardness_mpa(40.0) == pytest.approx(1.994, abs=1e-3)


def test_another_ratio_is_followed() -> None:
    equal = replace(MATERIALS["addition_40a"], parts_a=MaterialProperty(1, 1, "neat"), parts_b=MaterialProperty(1, 1, "neat"))
    assert split(equal, 10.0) == (5.0, 5.0)
    assert batch(equal, 0.01).a_g == pytest.approx(MIN_PART_G)


def test_the_mark_is_printed() -> None:
    assert str(MaterialProperty(5.0, 40.0, "neat")) == "5 to 40"
    assert str(MaterialProperty(1.08, 1.08, "", verified=False)) == "1.08 (unverified)"


def test_an_unknown_card_names_the_nearest() -> None:
    with pytest.raises(DesignError, match=r"--material: there is no 'sylgard'; did you mean sylgard_184\?"):
        silicone("sylgard")
