# SPDX-License-Identifier: Apache-2.0
"""Names of what laws keep: every law lists all that it keeps, in its order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.law.at_rest import history_at_rest
from presswork.law.history import AXES, BACK_STRESS, EQPS, RISE, TEMPERATURE, History, Part, list_history

MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
SWIFT = (_core.HardeningLaw.swift, [565.0, 0.007, 0.26])
HEATS = _core.Thermal(start=20.0, reference=20.0, melting=1520.0, exponent=1.1, heating=0.25)
CHABOCHE = _core.Chaboche(C=[3000.0, 800.0], gamma=[60.0, 0.0])
YOSHIDA = _core.YoshidaUemori(Y=124.0, B=168.0, C=500.0, m=12.0, b=10.0, Rsat=190.0, h=0.5)
KINDS: dict[int, Any] = {3: _core.SheetLaw, 4: _core.PlaneLaw, 6: _core.SolidLaw}
FEATURES: dict[str, tuple[dict[str, Any], dict[str, int]]] = {
    "plain": ({}, {EQPS: 1}),
    "heats": ({"thermal": HEATS}, {EQPS: 1, RISE: 1}),
    "chaboche": ({"chaboche": CHABOCHE}, {EQPS: 1, BACK_STRESS: -2}),
    "yoshida_uemori": (
        {"yoshida_uemori": YOSHIDA},
        {EQPS: 1, BACK_STRESS: -2, "expansion": 1, "stagnation_centre": -1, "stagnation_size": 1},
    ),
    "all": (
        {"thermal": HEATS, "chaboche": CHABOCHE, "expansion": [20.0, 0.0, 1e-5, 0.0]},
        {EQPS: 1, RISE: 1, BACK_STRESS: -2, TEMPERATURE: 1},
    ),
}
"""Keys of a law, and what it keeps: numbers, or, below zero, times the components of the stress."""


@pytest.mark.parametrize("components", KINDS)
@pytest.mark.parametrize("feature", FEATURES)
def test_a_law_names_all_that_it_keeps_in_its_order(components: int, feature: str) -> None:
    keys, expected = FEATURES[feature]
    law = KINDS[components](2e5, 0.3, MISES, *SWIFT, **keys)
    kept = list_history(law, components)
    sizes = {name: size if size > 0 else -size * components for name, size in expected.items()}
    axes = {} if components == 3 else {AXES: 2 if components == 4 else 6}
    assert {part.name: part.size for part in kept.parts} == sizes | axes
    assert [part.name for part in kept.parts] == [*sizes, *axes]
    assert kept.size == law.history_size + sum(axes.values())


def test_parts_are_found_by_name() -> None:
    kept = History((Part("a", 1), Part("b", 2), Part("axes", 2, is_axes=True)))
    values = np.arange(10.0).reshape(2, 5)
    assert [kept["a"], kept["b"], *kept.axes] == [slice(0, 1), slice(1, 3), slice(3, 5)]
    assert kept.of("a", values).tolist() == [0.0, 5.0]
    kept.of("b", values)[:] = 0.0
    assert values.tolist() == [[0, 0, 0, 3, 4], [5, 0, 0, 8, 9]]
    assert kept.without("a")["b"] == slice(0, 2)
    assert kept.behind("stress", 4)["a"] == slice(4, 5)
    with pytest.raises(KeyError, match="keeps no 'c': it keeps a, b, axes"):
        kept["c"]


@pytest.mark.parametrize("components", [4, 6])
def test_axes_at_rest_lie_along_the_rolling_direction(components: int) -> None:
    law = KINDS[components](2e5, 0.3, MISES, *SWIFT)
    kept = history_at_rest(law, (2,), components, rolling=(0.6, 0.8, 0.0))
    expected = [0.6, 0.8, 0.0, -0.8, 0.6, 0.0] if components == 6 else [0.6, 0.8]
    np.testing.assert_allclose(kept, [expected, expected], rtol=1e-15)
