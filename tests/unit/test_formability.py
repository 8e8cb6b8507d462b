# SPDX-License-Identifier: Apache-2.0
"""Margin, zones, thinning and wrinkling from strains made by hand; the verdict; what a results file keeps of them."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from presswork.case.material.forming_limit.curves import curve_from_points
from presswork.fields.formability_fields import formability_fields, judge_fields
from presswork.formability import (
    ZONES,
    Formability,
    find_margin,
    find_thinning,
    find_wrinkling,
    find_zones,
)
from presswork.model import CellBlock, Section
from tests.unit.case.round_cup import CUP

CURVE = curve_from_points([(-0.2, 0.5), (0.0, 0.3), (0.3, 0.4)])
MAJOR = np.array([0.2, 0.28, 0.36, 0.01, 0.2, 0.1])
MINOR = np.array([0.1, 0.0, 0.0, 0.005, -0.15, -0.15])
"""One point of each zone, in the order of ZONES."""
STRAINS = {"major_strain_middle": MAJOR, "minor_strain_middle": MINOR, "thickness_strain": -(MAJOR + MINOR)}
CENTRES = np.arange(18.0).reshape(6, 3)
SHELLS = [CellBlock("shell4_mitc", np.repeat(np.arange(6), 4).reshape(6, 4), 0, Section(0.8, 5))]
"""Each shell at a point, so that this is its middle."""


def test_margin_is_the_distance_to_the_curve_at_the_same_minor_strain() -> None:
    """The limits there are 0.3, 0.3 + 0.1/3, 0.4 by hand."""
    found = find_margin(np.array([0.0, 0.15, 0.5]), np.array([0.0, 0.1, -0.1]), CURVE)
    np.testing.assert_allclose(found, [1.0, 1 - 0.15 / (0.3 + 0.1 / 3), -0.25])


def test_margin_stays_finite_where_a_curve_drawn_on_falls_to_nothing() -> None:
    falling = curve_from_points([(-0.1, 0.1), (0.0, 0.3)])
    assert find_margin(np.array([0.2]), np.array([-0.15]), falling) == pytest.approx(-0.2 / 0.1)


def test_zones_and_margin_agree_everywhere() -> None:
    rng = np.random.default_rng(1)
    minor, major = rng.uniform(-0.4, 0.4, 5000), rng.uniform(0.03, 0.6, 5000)
    margin, zone = find_margin(major, minor, CURVE), find_zones(major, minor, CURVE, margin=0.08)
    np.testing.assert_array_equal(zone == 2, margin < 0)
    np.testing.assert_array_equal(zone == 1, (margin >= 0) & (margin < 0.08))


def test_thinning_is_per_cent_of_the_first_thickness() -> None:
    np.testing.assert_allclose(find_thinning(np.log([0.8, 1.0, 1.25])), [20.0, 0.0, -25.0], atol=1e-12)


def test_wrinkling_is_zero_in_tension_and_grows_with_compression_across() -> None:
    """Tension of r = 2 narrows by 2/3 of the stretch; pure shear lies 1/3 beyond it, compression alone by all of it."""
    major, minor = np.array([0.3, 0.3, 0.0, 0.3]), np.array([-0.2, -0.3, -0.1, 0.3])
    np.testing.assert_allclose(find_wrinkling(major, minor, r=2.0), [0.0, 0.1, 0.1, 0.0], atol=1e-15)


def test_fields_of_cells_name_each_zone() -> None:
    fields = formability_fields(STRAINS, [(Formability(CURVE), 0)])
    assert [ZONES[int(z)] for z in fields["formability_zone"]] == list(ZONES)
    np.testing.assert_allclose(fields["forming_limit_margin"][:3], [0.4, 0.02 / 0.3, -0.2])
    np.testing.assert_allclose(fields["thinning"][4:], -100 * np.expm1([-0.05, 0.05]))
    np.testing.assert_allclose(fields["wrinkling_indicator"][4:], [0.05, 0.1])


def test_margin_and_anisotropy_of_the_material_move_the_zones() -> None:
    assert formability_fields(STRAINS, [(Formability(CURVE, 0.05), 0)])["formability_zone"][1] == 0
    assert formability_fields(STRAINS, [(Formability(CURVE, r=4.0), 0)])["formability_zone"][4] == 0


def test_without_a_curve_nothing_is_said_of_cracks_and_of_solids_nothing_at_all() -> None:
    assert set(formability_fields(STRAINS, [(Formability(), 0)])) == {"thinning", "wrinkling_indicator"}
    assert formability_fields({"stress": np.zeros((6, 6))}, [(Formability(CURVE), 0)]) == {}
    verdict = judge_fields(STRAINS, SHELLS, CENTRES, [(Formability(), 0)])
    assert verdict is not None
    assert "no forming_limit, so cracks are not judged" in verdict.text()
    assert verdict.warnings() == []


def test_the_verdict_counts_failing_elements_and_names_the_worst_place() -> None:
    verdict = judge_fields(STRAINS, SHELLS, CENTRES, [(Formability(CURVE), 0)])
    assert verdict is not None
    assert (verdict.failing, verdict.margin.cell, verdict.margin.place) == (1, 2, (6.0, 7.0, 8.0))
    assert verdict.margin.value == pytest.approx(-0.2)
    assert verdict.zones == dict.fromkeys(ZONES, 1)
    assert verdict.thinning.cell == 2
    assert "1 of 6 elements lie above the forming limit, the worst by 20.0 % at (6, 7, 8) mm" in verdict.text()
    assert verdict.warnings() == [verdict.text()]


def test_the_verdict_on_a_sound_part_tells_its_least_margin() -> None:
    sound = {name: values[[0, 1]] for name, values in STRAINS.items()}
    shells = [replace(SHELLS[0], connectivity=SHELLS[0].connectivity[:2])]
    verdict = judge_fields(sound, shells, CENTRES, [(Formability(CURVE), 0)])
    assert verdict is not None
    assert "no element lies above the forming limit, 1 of 2 elements at risk; least margin 6.7 %" in verdict.text()


@pytest.mark.parametrize("judged", [Formability(), Formability(CURVE, 0.08, 1.7)])
def test_what_a_results_file_keeps_is_read_back(judged: Formability) -> None:
    again = Formability.from_info(judged.to_info())
    assert (again.safety_margin, again.r) == (judged.safety_margin, judged.r)
    assert (again.curve is None) == (judged.curve is None)
    if judged.curve is not None:
        np.testing.assert_array_equal(again.curve.major, judged.curve.major)
        assert again.curve.method == "from points"


def pulled_strip(**material: object) -> StampingCase:
    sheet = {"young": "206 GPa", "poisson": 0.3, "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}
    return StampingCase.model_validate({
        "title": "strip", "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel"},
        "materials": {"steel": sheet | material, "spare": sheet},
        "boundary": {"grip": {"set": "left", "hold": "clamped"}},
        "stages": [{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 1}]}],
    })  # fmt: skip


@pytest.mark.parametrize(("material", "margin"), [
    ({}, 0.1), ({"young": "70 GPa"}, 0.08), ({"forming_limit": {"safety_margin": 0.2}}, 0.2),
])  # fmt: skip
def test_the_model_carries_the_curve_the_margin_and_the_normal_anisotropy(material: dict, margin: float) -> None:
    limit = {"law": "keeler", "thickness": 0.8, "n": 0.26} | material.pop("forming_limit", {})
    hill = {"law": "hill1948", "r00": 1.79, "r45": 1.51, "r90": 2.27}
    model = build_model(pulled_strip(**material, forming_limit=limit, yield_function=hill))
    judged = model.materials[0].formability
    assert judged.curve is not None
    assert judged.curve.method == "Keeler, t = 0.8 mm, n = 0.26"
    assert judged.safety_margin == margin
    assert judged.r == pytest.approx((1.79 + 2 * 1.51 + 2.27) / 4)
    assert model.materials[1].formability.curve is None


@pytest.mark.parametrize(("material", "words"), [
    ({"forming_limit": {"law": "keeler", "thickness": 8, "n": 0.26}}, r"steel\.forming_limit\.thickness = 8"),
    ({"forming_limit": {"law": "points", "points": [[0, 0.3]]}}, r"steel\.forming_limit\.points: .*two"),
    ({"forming_limit": {"law": "swift_hill"}, "hardening": {"law": "linear", "yield_stress": 200, "modulus": 0}},
     r"materials\.steel\.hardening: .*too little"),
    ({"forming_limit": {"law": "swift_hill"}, "kinematic": {"law": "chaboche", "C": [2000], "gamma": [20]}},
     r"materials\.steel\.forming_limit\.law: .*isotropic hardening alone"),
])  # fmt: skip
def test_a_limit_that_cannot_be_found_is_refused_by_its_key_in_the_case(material: dict, words: str) -> None:
    with pytest.raises(CaseError, match=words):
        build_model(pulled_strip(**material))


def test_a_foil_is_named_by_its_own_key_and_computed_with_another_limit() -> None:
    """The blank is 0.05 mm thick, which Keeler's formula does not cover; the key is that of the thickness."""
    cup = copy.deepcopy(CUP)
    cup["blank"] |= {"thickness": 0.05, "material": "dc04"}
    cup["tools"] = {"punch": cup["tools"]["punch"], "die": cup["tools"]["die"]}
    cup["stages"] = [{"name": "draw", "tools": {"punch": {"stroke": 2}}}]
    with pytest.raises(CaseError, match=r"blank\.thickness = 0\.05.*marciniak_kuczynski"):
        build_model(StampingCase.model_validate(cup))
    cup["materials"] = {"dc04": {"library": "dc04", "forming_limit": {"law": "marciniak_kuczynski"}}}
    assert build_model(StampingCase.model_validate(cup)).sheet[0].thickness == 0.05


def test_a_computed_limit_of_the_library_gives_way_to_back_stresses_of_the_case(
    caplog: pytest.LogCaptureFixture,
) -> None:
    own: dict = {"library": "aa6016_t4", "kinematic": {"law": "chaboche", "C": [2000], "gamma": [20]}}
    case = pulled_strip().model_dump()
    judged = build_model(StampingCase.model_validate(case | {"materials": {"steel": own}})).materials[0].formability
    assert judged.curve is None
    assert "its forming limit is computed for isotropic hardening" in caplog.text
    points = own | {"forming_limit": {"law": "points", "points": [[-0.2, 0.5], [0.2, 0.4]]}}
    kept = build_model(StampingCase.model_validate(case | {"materials": {"steel": points}})).materials[0].formability
    assert kept.curve is not None
    alone = {"library": "aa6016_t4"}
    found = build_model(StampingCase.model_validate(case | {"materials": {"steel": alone}})).materials[0].formability
    assert found.curve is not None
    assert "Marciniak" in found.curve.method
