"""Silicones: every property has a source or is marked as unverified.

Quantities follow in closed form.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.mixture import (
    MIN_COMPONENT_G,
    MIN_MIX_G,
    WASTE_FRACTION,
    compute_batch,
    measure_poured_cm3,
    mix,
    parts_by_weight,
    split_by_mix_ratio,
)
from fingertip.catalogues.materials import MaterialProperty, Silicone, load_silicones, load_sources
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.models.parts import PARTS

SILICONES = load_silicones()
SOURCES = load_sources()

UNREAD = {"", "common", "trade", "recalled"}
"""Sources that are no document."""


@pytest.mark.every_case
@pytest.mark.parametrize("silicone", SILICONES.values(), ids=SILICONES)
class TestEachSilicone:
    def test_every_property_has_a_source_or_is_marked_as_unverified(
        self, silicone: Silicone
    ) -> None:
        for name, value in silicone.properties().items():
            assert value.source in SOURCES, name
            assert value.verified == (value.source not in UNREAD), (
                f"{name}: its mark does not fit its source"
            )
            assert 0.0 <= value.low <= value.high, name
            assert value.low > 0.0 or name == "shrinkage_percent", name

    def test_batch_is_the_mold_content_plus_waste(self, silicone: Silicone) -> None:
        batch = compute_batch(silicone, 40.0)
        assert batch.in_cup_g == pytest.approx(40.0 * silicone.density_g_cm3.high)
        assert batch.total_g == pytest.approx((1 + WASTE_FRACTION) * batch.in_cup_g)
        assert batch.a_g + batch.b_g == pytest.approx(batch.total_g)
        assert batch.a_g / batch.b_g == pytest.approx(
            silicone.parts_a.low / silicone.parts_b.low, rel=1e-14
        )

    def test_small_batch_is_large_enough_to_weigh_and_to_stir(self, silicone: Silicone) -> None:
        batch = compute_batch(silicone, 1.0)
        ratio = silicone.parts_a.low / silicone.parts_b.low
        least_g = max(MIN_COMPONENT_G, MIN_MIX_G / (1 + ratio))
        assert batch.b_g == pytest.approx(least_g) == {10.0: 2.0, 1.0: 5.0}[ratio]
        assert batch.a_g == pytest.approx(ratio * least_g)


@pytest.mark.parametrize(
    "table",
    [
        {"source": "neat"},
        {"value": 30.0, "low": 20.0, "high": 40.0},
        {"low": 20.0},
        {"value": 30.0, "verifed": False},
        {"value": "30 to 40"},
    ],
    ids=str,
)
def test_a_property_states_a_value_or_both_ends_of_a_range(table: dict[str, Any]) -> None:
    assert MaterialProperty.from_table(value=30) == MaterialProperty(30.0, 30.0, "")
    with pytest.raises((TypeError, ValueError)):
        MaterialProperty.from_table(**table)


def test_ratio_by_volume_is_converted_with_both_densities() -> None:
    def density(value: float) -> MaterialProperty:
        return MaterialProperty(value, value, "neat")

    by_volume = replace(
        SILICONES["mold_star_30"], density_a_g_cm3=density(1.2), density_b_g_cm3=density(1.0)
    )
    assert parts_by_weight(by_volume) == (1.2, 1.0)
    assert split_by_mix_ratio(by_volume, 22.0) == pytest.approx((12.0, 10.0))
    half_known = replace(by_volume, density_b_g_cm3=None)
    assert parts_by_weight(half_known) == (1.0, 1.0)
    by_weight = replace(by_volume, ratio_by="weight or volume")
    assert parts_by_weight(by_weight) == (1.0, 1.0), "a ratio by weight needs no conversion"


def test_design_names_its_silicone_and_an_option_replaces_it() -> None:
    assert Design().silicone.material == SILICONES["smooth_sil_940"]
    design = Design.load(changes=["silicone.product=mold_star_30"])
    assert design.silicone.material == SILICONES["mold_star_30"]
    assert design.with_silicone(None) is design
    replaced = design.with_silicone("sylgard_184")
    assert replaced.silicone.material == SILICONES["sylgard_184"]
    assert replaced == Design.load(changes=["silicone.product=sylgard_184"])
    assert replaced.dimensions.sensor == design.dimensions.sensor


def test_own_silicone_has_the_figures_of_the_design() -> None:
    figures = {
        "viscosity_pa_s": 18.0,
        "density_g_cm3": 1.14,
        "parts_a": 100.0,
        "parts_b": 5.0,
        "pot_life_min": 20.0,
        "cure_h": 8.0,
        "shore_a": 37.0,
        "modulus_mpa": 1.3,
        "elongation_percent": 310.0,
        "shrinkage_percent": 0.5,
    }
    changes = [f"silicone.{name}={value}" for name, value in figures.items()]
    names = ["silicone.product=own", "silicone.label=Rubber 37", "silicone.cure=condensation"]
    own = Design.load(changes=[*names, *changes]).silicone.material
    assert (own.label, own.cure, own.components) == (
        "Rubber 37",
        "condensation",
        ("base", "catalyst"),
    )
    assert {name: (value.low, value.high) for name, value in own.properties().items()} == {
        name: (value, value) for name, value in figures.items()
    }
    assert {SOURCES[value.source] for value in own.properties().values()} == {
        "the table [silicone] of the design file"
    }
    assert compute_batch(own, 100.0).b_g == pytest.approx(1.25 * 114.0 / 21.0)


def test_unknown_silicone_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(
        DesignError, match=r"material: there is no 'sylgard'; did you mean sylgard_184\?"
    ):
        Design().with_silicone("sylgard")
    with pytest.raises(
        DesignError, match=r"'dragonskin_30' is not known; .* Did you mean dragon_skin_30\?"
    ) as caught:
        Design.load(changes=["silicone.product=dragonskin_30"])
    assert [issue.field for issue in caught.value.issues] == ["silicone.product"]


@pytest.mark.parametrize(
    "label", ["a|b", "", "x" * 61, " x", "two\\nlines", "=1+1", "$x$", "[a](b)", "a\u202eb"]
)
def test_label_that_would_break_a_page_is_refused(label: str) -> None:
    with pytest.raises(DesignError, match="cannot stand here; write up to 60 printable characters"):
        Design.load(changes=[f'silicone.label="{label}"'])


def test_a_third_more_is_poured_than_the_skin_takes() -> None:
    """The cavity is larger than the skin by the shrinkage, 0.3 % in each direction."""
    design = Design.load("first_finger")
    evaluator = MeshEvaluator(0.02)
    skin_cm3 = evaluator.manifold(PARTS["skin"].solid(design)).volume() / 1000.0
    assert measure_poured_cm3(design, evaluator) == pytest.approx(1.35 * skin_cm3, rel=0.03)


def test_mixture_is_rounded_to_what_a_scale_reads() -> None:
    mixture = mix(load_silicones()["smooth_sil_940"], 40.0)
    assert (mixture.in_cup_g, mixture.a_g, mixture.b_g, mixture.total_g) == (47.2, 53.6, 5.4, 59.0)
