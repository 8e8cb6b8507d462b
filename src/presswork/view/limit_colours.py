# SPDX-License-Identifier: Apache-2.0
"""Colours of fields that have a limit: green where it is far, yellow near it, red beyond."""

from __future__ import annotations

from typing import TYPE_CHECKING

from presswork.formability import PATH_MARGINS
from presswork.results import Result

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable

GREEN, YELLOW, RED, DARK_RED = "#1a9850", "#fee08b", "#d73027", "#7f0000"
NEAR = 0.8
"""Part of a limit from which on a value is near it: yellow."""
_MARGINS = ("forming_limit_margin", *PATH_MARGINS)

Stops = list[tuple[float, str]]


def find_stops(result: Result, field: str, low: float, high: float) -> Stops:
    """Return values with their colours, increasing, for a field from low to high; none for a field without a limit.

    Margins to the forming limit are red below zero and yellow at the safety margin; damage is red from its critical
    value on.
    """
    if field in _MARGINS:
        reserve = result.formability.safety_margin
        stops = [(0.0, RED), (reserve, YELLOW), (max(high, 2.0 * reserve), GREEN)]
        return [(low, DARK_RED), *stops] if low < 0.0 else stops
    limit = result.summary.get("damage", {}).get(field, {}).get("critical")
    if not limit or limit <= 0.0:
        return []
    stops = [(min(low, 0.0), GREEN), (NEAR * limit, YELLOW), (float(limit), RED)]
    return [*stops, (high, DARK_RED)] if high > limit else stops


def find_fixed_stops(result: Result, field: str) -> Stops:
    """Return find_stops for colours that stay from step to step: a margin up to 1, damage a quarter beyond critical."""
    if field in _MARGINS:
        return find_stops(result, field, -result.formability.safety_margin, 1.0)
    critical = result.summary.get("damage", {}).get(field, {}).get("critical") or 0.0
    return find_stops(result, field, 0.0, 1.25 * critical)


def make_limit_colours(stops: Stops) -> ScalarMappable:
    """Return the colours of stops."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    low, high = stops[0][0], stops[-1][0]
    places = [((value - low) / (high - low), colour) for value, colour in stops]
    return ScalarMappable(Normalize(low, high), LinearSegmentedColormap.from_list("limit", places))
