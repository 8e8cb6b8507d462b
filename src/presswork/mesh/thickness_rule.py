# SPDX-License-Identifier: Apache-2.0
"""Integration through the thickness of a sheet: positions in [-1, 1] from bottom to top, weights that sum to 2."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, Section


def thickness_rule(section: Section) -> tuple[FloatArray, FloatArray]:
    """Return the positions and weights (points,) of a section's rule.

    Gauss's rule is exact for polynomials of degree 2 n - 1, Lobatto's, which has points on both faces, of 2 n - 3;
    Simpson's has equally spaced points, an odd number of them.
    Raises ValueError for a number of points that the rule does not have, or without thickness.
    """
    n = section.points
    check_section(section)
    if section.rule == "gauss":
        positions, weights = np.polynomial.legendre.leggauss(n)
    elif section.rule == "lobatto":
        last = np.polynomial.legendre.Legendre.basis(n - 1)
        positions = np.concatenate([[-1.0], np.sort(np.real(last.deriv().roots())), [1.0]])
        weights = 2.0 / (n * (n - 1) * last(positions) ** 2)
    else:
        positions = np.linspace(-1.0, 1.0, n)
        weights = np.where(np.arange(n) % 2 == 1, 4.0, 2.0) * 2.0 / (3 * (n - 1))
        weights[[0, -1]] /= 2.0
    return positions, weights


def check_section(section: Section) -> None:
    """Raise ValueError for a section without thickness, or a number of points that its rule does not have."""
    if not section.thickness > 0:
        raise ValueError(f"a section has a thickness greater than 0, not {section.thickness:g} mm")
    if not 2 <= section.points <= 51:
        raise ValueError(f"a section has 2 to 51 points through the thickness, not {section.points}")
    if section.rule == "simpson" and section.points % 2 == 0:
        raise ValueError(f"Simpson's rule has an odd number of points, not {section.points}")
