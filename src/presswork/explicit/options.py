# SPDX-License-Identifier: Apache-2.0
"""How shells of an explicit run are computed: the choices, and the points through the thickness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.model import ExplicitElement


@dataclass(frozen=True, kw_only=True)
class ShellOptions:
    """How a shell is computed.

    element: of four nodes; "shell4_1pt", or "shell4_mitc_plus", fully integrated on 2 x 2 points in the plane,
    which has no hourglass modes, and no use for warping, hourglass and coefficients. Triangles are of one point.
    n_points, rule: points through the thickness; "gauss" or, with points on both surfaces, "lobatto".
    warping: Belytschko, Wong & Chiang's terms for warped elements; without them it is Belytschko & Tsay's shell.
    hourglass: "physical", stresses with the material's own moduli; or "stiffness" or "viscous" control by perturbation,
    with its coefficients for membrane, deflection and rotations.
    tabulate: hardening is looked up in a table that follows its law within 1e-8 where it is smooth; von Mises with
    isotropic hardening alone takes a fast update besides.
    ironing: shells between two tools that leave less room than they are thick are squeezed thinner, with the pressure
    as stress through the thickness; without it tools sink into the sheet instead.
    """

    element: ExplicitElement = "shell4_1pt"
    n_points: int = 5
    rule: Literal["gauss", "lobatto"] = "gauss"
    warping: bool = True
    hourglass: Literal["physical", "stiffness", "viscous"] = "physical"
    coefficients: tuple[float, float, float] = (0.03, 0.03, 0.03)
    tabulate: bool = True
    ironing: bool = True

    def __post_init__(self) -> None:
        least = 1 if self.rule == "gauss" else 2
        if not least <= self.n_points <= 51:
            raise ExplicitError(f"n_points = {self.n_points}: a {self.rule} rule has {least} to 51 points")
        if any(not 0 <= c <= 0.2 for c in self.coefficients):
            raise ExplicitError(f"coefficients = {self.coefficients}: hourglass coefficients lie between 0 and 0.2")
        if self.element not in get_args(ExplicitElement):
            raise ExplicitError(f"element = {self.element!r}: give {' or '.join(get_args(ExplicitElement))}")
        one_point = (True, "physical", ShellOptions.coefficients)
        if self.element == "shell4_mitc_plus" and (self.warping, self.hourglass, self.coefficients) != one_point:
            raise ExplicitError(
                'element = "shell4_mitc_plus" has no hourglass modes: leave out warping, hourglass and coefficients'
            )
        if self.hourglass == "physical" and not self.warping:
            raise ExplicitError(
                'warping = False: hourglass = "physical" includes the warping terms; with them off, give hourglass = '
                '"stiffness" or "viscous"'
            )

    @property
    def treatment(self) -> _core.ShellTreatment:
        """The kernel's name for it."""
        if self.element == "shell4_mitc_plus":
            return _core.ShellTreatment.mitc
        if self.hourglass == "physical":
            return _core.ShellTreatment.stabilized
        return _core.ShellTreatment.warped if self.warping else _core.ShellTreatment.plain


def layer_rule(n_points: int, rule: str) -> tuple[list[float], list[float]]:
    """Give heights from -1 to 1 and weights that add up to one.

    >>> layer_rule(3, "lobatto")[0]
    [-1.0, 0.0, 1.0]
    """
    if rule == "gauss":
        height, weight = np.polynomial.legendre.leggauss(n_points)
    else:
        last = np.polynomial.legendre.Legendre.basis(n_points - 1)
        inner = np.real(last.deriv().roots()) if n_points > 2 else np.empty(0)
        height = np.concatenate(([-1.0], np.sort(inner), [1.0]))
        weight = 2.0 / (n_points * (n_points - 1) * last(height) ** 2)
    height = 0.5 * (height - height[::-1])  # symmetric to the last bit
    return height.tolist(), (0.25 * (weight + weight[::-1])).tolist()
