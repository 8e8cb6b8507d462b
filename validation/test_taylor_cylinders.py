# SPDX-License-Identifier: Apache-2.0
"""Measured Taylor cylinders: what was written down is what the program computes, and how far it is off."""

import json

import pytest

from validation.taylor_cylinders import METALS, SETS, TEMPERS, measure, read_results, read_shots, split, strike

pytestmark = pytest.mark.validation


def test_half_of_each_metals_shots_are_fitted() -> None:
    shots = read_shots()
    fitted = split(shots)
    assert len(shots) == 145
    for metal in METALS:
        own = [is_own for shot, is_own in zip(shots, fitted, strict=True) if shot.metal == metal]
        assert 0.45 < sum(own) / len(own) < 0.55
    assert split(shots, seed=1) != fitted


@pytest.mark.parametrize("source", ["StHouse", "StGust", "AlHouse", "CuHouse"])
def test_results_are_those_of_the_program(source: str) -> None:
    sets = json.loads(SETS.read_text("utf-8"))
    pairs = [(s, r) for s, r in zip(read_shots(), read_results(), strict=True) if s.source == source][::3]
    for shot, result in pairs:
        found = strike(shot, list(sets[shot.metal].values()))
        assert found.length / shot.length == pytest.approx(result.length[1], abs=2e-4)


@pytest.mark.parametrize(
    ("metal", "length", "foot"), [("4340 steel", 2.2, 2.6), ("6061-T6", 2.2, 2.7), ("copper", 6.6, 2.3)]
)
def test_predicted_shots_are_within_the_published_error(metal: str, length: float, foot: float) -> None:
    found = measure([one for one in read_results() if one.metal == metal and not one.fitted])
    assert found["failed"] == 0
    assert found["length"] < length
    assert found["foot"] < foot


def test_two_tempers_halve_the_error_of_copper() -> None:
    predicted = [one for one in read_results() if one.source in TEMPERS and not one.fitted]
    assert measure(predicted, 3)["length"] < 0.5 * measure(predicted, 1)["length"]


def test_fitted_sets_are_better_than_the_usual_ones_on_shots_that_they_do_not_know() -> None:
    for metal in METALS:
        predicted = [one for one in read_results() if one.metal == metal and not one.fitted]
        fitted, usual = measure(predicted), measure(predicted, 2)
        assert fitted["length"] < usual["length"]
        assert fitted["foot"] < 0.5 * usual["foot"]
