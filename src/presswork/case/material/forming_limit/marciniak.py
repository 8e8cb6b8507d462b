# SPDX-License-Identifier: Apache-2.0
"""Marciniak & Kuczynski's forming limit for any yield function, hardening and rate law, with a groove that turns.

The sheet A strains proportionally; a groove B in it is thinner by the factor f and lies at an angle. Rigid-plastic:

    force across the groove     s_nn^B t^B = s_nn^A t^A,   s_nt^B t^B = s_nt^A t^A
    strain along the groove     d e_tt^B = d e_tt^A
    flow in the groove          f(s^B) = flow(p^B, dp^B/dt)

The groove is driven: its equivalent plastic strain goes up in steps, and stress in B (3) and strain of A (1) are found
by Newton from the four equations, with two-step backward differences (second order; the trapezoidal rule would ring).
So the limit, where A strains no more, is approached without a singularity. The groove's normal turns with the sheet,
tan psi = tan psi0 exp(e1 - e2) (Hutchinson & Neale 1978). The limit is the lowest over groove angles.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from presswork import _core
from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.proportional import ProportionalPath, find_stress, turn_stress
from presswork.case.material.yld2000_fit import r_value
from presswork.formability import FormingLimitCurve
from presswork.model import BoolArray, FloatArray

_LARGEST_STEP = 2e-3
_LARGEST_STRAIN = 5.0
_STANDSTILL = 1e-3
"""Strain increment of the sheet over that of the groove below which the sheet counts as no longer straining."""
_SMALLEST_FACTOR = 1e-3
"""Or when no solution is found with this part of a step."""


@dataclass(frozen=True)
class _Grooves:
    """What is known of m grooves and of the sheet beside them; axes of the material."""

    tan_psi: FloatArray
    """Tangent of the groove's angle at the start, shape (m,)."""
    sheet_stress: FloatArray
    """Stress of the sheet over its flow stress, shape (m, 3)."""
    sheet_normal: FloatArray
    """d f/d stress of the sheet, shape (m, 3)."""
    sheet_rate: FloatArray
    """Principal strains of the sheet per unit of its equivalent plastic strain, shape (m, 2)."""
    sheet_speed: FloatArray
    """Equivalent plastic strain rate of the sheet [1/s], shape (m,)."""
    stress: FloatArray
    """Stress in the groove [MPa], shape (m, 3)."""
    p: FloatArray
    """Equivalent plastic strain in the groove."""
    p_sheet: FloatArray
    """Equivalent plastic strain of the sheet, now and a step before, shape (2, m)."""
    thinning: FloatArray
    """Thickness strain of the groove, now and a step before, shape (2, m)."""
    step: FloatArray
    """The step before, of the groove's equivalent plastic strain, shape (m,); 0 before the first."""

    def speed(self) -> FloatArray:
        """Return the last step's strain of the sheet over that of the groove; below everything before the first."""
        change = self.p_sheet[0] - self.p_sheet[1]
        return np.where(self.step > 0, change / np.maximum(self.step, 1e-300), -np.inf)

    def where(self, mask: BoolArray, other: _Grooves) -> _Grooves:
        """Return the grooves of a mask, and those of another for the rest."""
        return replace(
            self,
            stress=np.where(mask[:, None], self.stress, other.stress),
            **{name: np.where(mask, getattr(self, name), getattr(other, name)) for name in ("p", "step", *_LAST)},
        )

    def keep(self, mask: BoolArray) -> _Grooves:
        """Return the grooves of a mask."""
        return _Grooves(
            **{
                f.name: getattr(self, f.name)[..., mask] if f.name in _LAST else getattr(self, f.name)[mask]
                for f in fields(self)
            }
        )


_LAST = ("p_sheet", "thinning")
"""Arrays whose last axis counts grooves."""


def marciniak_kuczynski_curve(
    function: _core.YieldFunction,
    law: _core.SheetLaw,
    *,
    imperfection: float = 0.996,
    ratios: FloatArray | None = None,
    angle: float = 0.0,
    groove_angles: FloatArray | None = None,
    rate: float = 1e-3,
) -> FormingLimitCurve:
    """Compute the forming limit curve of Marciniak and Kuczynski.

    law: flow stress and rate law; back stresses are not in the theory. imperfection: thickness of the groove over that
    of the sheet. ratios: minor over major strain; without it from tension to balanced stretching. angle: of the major
    strain from the rolling direction [degrees].
    groove_angles: between the groove's normal and the major strain at the start [degrees]; without it 0 to 45 by 3, and
    the same to the other side unless the axes are those of the sheet. rate: major strain rate of the sheet [1/s].
    Raises CaseError for an imperfection that is none, or a groove that the sheet never stops at.
    """
    if not 0.5 < imperfection < 1.0:
        expected = "expected a thickness ratio above 0.5 and below 1"
        raise CaseError([Problem("imperfection", expected, "0.99 to 0.999 is usual", imperfection)], "forming limit")
    if ratios is None:
        r = float(r_value(function, np.radians([angle]))[0])
        ratios = np.concatenate([np.linspace(-r / (1 + r), 0.0, 6), np.linspace(0.1, 1.0, 10)])
    ratios = np.asarray(ratios, dtype=float)
    if groove_angles is None:
        groove_angles = np.arange(0.0, 46.0, 3.0)
        if angle % 90.0:
            groove_angles = np.concatenate([-groove_angles[:0:-1], groove_angles])
    path = find_stress(function, np.repeat(ratios, len(groove_angles)), angle)
    psi = np.radians(np.tile(groove_angles, len(ratios)))
    p = _follow_grooves(function, law, path, psi, imperfection, rate, len(ratios))
    if not np.isfinite(p).all():
        text = f"no groove stops the sheet at the strain ratio {ratios[~np.isfinite(p)][0]:g}"
        remedy = "give groove angles down to 0, or check that the hardening slows down"
        raise CaseError([Problem("", text, remedy)], "forming limit")
    strain = p[:, None] * path.rate[:: len(groove_angles)]
    order = np.argsort(strain[:, 1])
    return FormingLimitCurve(strain[order, 1], strain[order, 0], f"Marciniak-Kuczynski, f = {imperfection:g}")


def _follow_grooves(
    function: _core.YieldFunction,
    law: _core.SheetLaw,
    path: ProportionalPath,
    psi: FloatArray,
    imperfection: float,
    rate: float,
    n_ratios: int,
) -> FloatArray:
    """Return the lowest equivalent plastic strain of the sheet where it stops, by ratio; infinite if it does not."""
    m = len(psi)
    family = np.repeat(np.arange(n_ratios), m // n_ratios)
    unit = turn_stress(path.stress, -path.angle)
    start = law.flow_stress(np.zeros(m))[0][:, None] * unit
    zero = np.zeros((2, m))
    grooves = _Grooves(
        np.tan(psi), unit, function.evaluate(unit)[1], path.rate, rate / path.rate[:, 0], start, zero[0], zero, zero,
        zero[0],
    )  # fmt: skip
    equations = _Equations(function, law, path.angle, imperfection)
    # 1. the groove yields first, while the sheet stands: plane strain along the groove
    grooves = equations.start(grooves)
    limit, factor = np.full(n_ratios, np.inf), np.ones(m)
    # 2. steps of the groove until the sheet stands; close to that there may be no solution a whole step on
    while len(family) and grooves.p.max() < _LARGEST_STRAIN:
        step = factor * np.minimum(_LARGEST_STEP, 0.2 * grooves.p + 1e-5)
        after, found = equations.advance(grooves, step)
        speed, speed_before = after.speed(), grooves.speed()
        # with an infinite slope of hardening at first the sheet starts from rest: slow is not enough, it must slow down
        stopped = found & (speed < np.minimum(_STANDSTILL, speed_before)) | (factor < _SMALLEST_FACTOR)
        np.minimum.at(limit, family[stopped], grooves.p_sheet[0][stopped])
        # 3. a groove that has let the sheet go farther than another is not the worst
        go_on = ~stopped & (grooves.p_sheet[0] < limit[family])
        grooves = after.where(found, grooves).keep(go_on)
        family, factor = family[go_on], np.where(found, np.minimum(2 * factor, 1.0), 0.25 * factor)[go_on]
    return limit


class _Equations:
    """The four equations of a step and their solution by Newton."""

    def __init__(self, function: _core.YieldFunction, law: _core.SheetLaw, angle: float, imperfection: float) -> None:
        self.function, self.law, self.angle, self.imperfection = function, law, angle, imperfection

    def axes(self, grooves: _Grooves, p_sheet: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return rows that give s_nn and s_nt from a stress, and e_tt from a strain with engineering shear."""
        turn = (grooves.sheet_rate[:, 0] - grooves.sheet_rate[:, 1]) * p_sheet
        phi = self.angle + np.arctan(grooves.tan_psi * np.exp(turn))
        c, s = np.cos(phi), np.sin(phi)
        across = np.stack([c * c, s * s, 2 * s * c], axis=1)
        shear = np.stack([-s * c, s * c, c * c - s * s], axis=1)
        along = np.stack([s * s, c * c, -s * c], axis=1)
        return across, shear, along

    def start(self, grooves: _Grooves) -> _Grooves:
        """Find the plastic strain in the groove at which the sheet yields: plane strain along the groove.

        With the force across given, plane strain is where the equivalent stress is least over the stress along. Where
        that is below yield, groove and sheet start together.
        """
        along = self.axes(grooves, grooves.p)[2]
        start = self.law.flow_stress(grooves.p)[0]
        sheet = grooves.sheet_stress * start[:, None]
        p = thinning = np.zeros_like(start)
        for _ in range(10):  # the groove thins a little on the way
            stress, flow, out = self.hold(sheet / (self.imperfection * np.exp(thinning))[:, None], along, start)
            low, high = np.zeros_like(start), np.ones_like(start)
            for _ in range(60):
                p = 0.5 * (low + high)
                enough = self.law.flow_stress(p)[0] > flow
                low, high = np.where(enough, low, p), np.where(enough, p, high)
            p = np.where(flow > start, high, 0.0)
            thinning = -p * out
        stress = np.where(p[:, None] > 0, stress, sheet)
        return replace(grooves, stress=stress, p=p, thinning=np.stack([thinning, thinning]))

    def hold(
        self, force: FloatArray, along: FloatArray, start: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Add the stress along the groove that holds it; return stress, equivalent stress, and thinning by p."""
        low, high = -4.0 * start, 4.0 * start
        for _ in range(60):
            middle = 0.5 * (low + high)
            value, normal, _ = self.function.evaluate(force + middle[:, None] * along)
            pushed = (along * normal).sum(axis=1) > 0
            low, high = np.where(pushed, low, middle), np.where(pushed, middle, high)
        return force + middle[:, None] * along, value, normal[:, 0] + normal[:, 1]

    def advance(self, grooves: _Grooves, step: FloatArray) -> tuple[_Grooves, BoolArray]:
        """Advance the grooves by steps of their equivalent plastic strain; return which found a solution."""
        # y = base + weight y', the two-step backward difference formula of uneven steps
        w = np.where(grooves.step > 0, step / np.maximum(grooves.step, 1e-300), 0.0)
        weight = step * (1 + w) / (1 + 2 * w)
        base_sheet, base_thin = (
            ((1 + w) ** 2 * now - w**2 * before) / (1 + 2 * w) for now, before in (grooves.p_sheet, grooves.thinning)
        )
        forecast = grooves.p_sheet[0] + np.where(w > 0, w * (grooves.p_sheet[0] - grooves.p_sheet[1]), 0.9 * step)
        axes = self.axes(grooves, forecast)
        p_sheet, p = forecast, grooves.p + step
        stress = grooves.stress * (self.law.flow_stress(p)[0] / self.law.flow_stress(grooves.p)[0])[:, None]
        for _ in range(12):
            speed = (p_sheet - base_sheet) / weight
            residual, matrix, thinning = self.linearise(grooves, axes, stress, p, p_sheet, speed, weight, base_thin)
            found = np.abs(residual).max(axis=1) < 1e-10
            if found.all():
                break
            change = np.linalg.solve(matrix, -residual[..., None])[..., 0]
            largest = np.abs(change[:, :3]).max(axis=1) / np.abs(stress).max(axis=1)
            change *= np.minimum(1.0, 0.2 / np.maximum(largest, 1e-300))[:, None]
            # the flow stress of some laws starts with an infinite slope: p_sheet stays positive
            stress, p_sheet = stress + change[:, :3], np.maximum(p_sheet + change[:, 3], 0.1 * p_sheet)
        after = replace(
            grooves,
            stress=stress,
            p=p,
            p_sheet=np.stack([p_sheet, grooves.p_sheet[0]]),
            thinning=np.stack([thinning, grooves.thinning[0]]),
            step=step,
        )
        return after, found

    def linearise(
        self,
        grooves: _Grooves,
        axes: tuple[FloatArray, FloatArray, FloatArray],
        stress: FloatArray,
        p: FloatArray,
        p_sheet: FloatArray,
        speed: FloatArray,
        weight: FloatArray,
        base_thin: FloatArray,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return residual (m, 4), its derivative by stress and unknown, and the groove's thickness strain.

        The unknown is p_sheet; speed: d p_sheet/d p.
        """
        across, shear, along = axes
        value, normal, hessian = self.function.evaluate(stress)
        flow = self.law.flow_stress(p)[0]
        sheet_flow, sheet_slope = self.law.flow_stress(p_sheet)
        out, sheet_out = normal[:, 0] + normal[:, 1], grooves.sheet_normal[:, 0] + grooves.sheet_normal[:, 1]
        thinning = base_thin - weight * out
        ratio = self.imperfection * np.exp(thinning + p_sheet * sheet_out)
        fast = np.maximum(speed, 1e-6)
        factor, factor_slope = self.law.rate_factor(grooves.sheet_speed / fast)
        unit = sheet_flow * self.law.rate_factor(grooves.sheet_speed)[0]
        residual, matrix = np.zeros((len(p), 4)), np.zeros((len(p), 4, 4))
        for i, row in enumerate((across, shear)):
            force = ratio * (row * stress).sum(axis=1) / unit
            residual[:, i] = force - (row * grooves.sheet_stress).sum(axis=1)
            matrix[:, i, :3] = (ratio / unit)[:, None] * row
            matrix[:, i, :3] -= (force * weight)[:, None] * (hessian[:, 0] + hessian[:, 1])
            matrix[:, i, 3] = force * (sheet_out - sheet_slope / sheet_flow)
        sheet_along = (along * grooves.sheet_normal).sum(axis=1)
        residual[:, 2] = (along * normal).sum(axis=1) - speed * sheet_along
        matrix[:, 2, :3] = np.einsum("mi,mij->mj", along, hessian)
        matrix[:, 2, 3] = -sheet_along / weight
        residual[:, 3] = value / flow - factor
        matrix[:, 3, :3] = normal / flow[:, None]
        matrix[:, 3, 3] = factor_slope * grooves.sheet_speed / fast**2 / weight
        return residual, matrix, thinning
