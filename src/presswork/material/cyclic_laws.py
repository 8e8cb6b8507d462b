# SPDX-License-Identifier: Apache-2.0
"""Laws of isotropic and kinematic hardening in tension and compression in turn, for many sets of parameters at once.

One stress component; s is the sense of flow, p the plastic strain since the start, stress = s Y + back stress:
    isotropic        Y = Y0 + (Ysat - Y0)(1 - exp(-rate p)) + modulus p
    Chaboche         Y by Voce's law (no modulus), d a_i = (C_i s - gamma_i a_i) dp: along a branch in closed form
    Yoshida-Uemori   Y constant, back stress theta + beta, a = B + R - Y (Int. J. Plasticity 18 (2002) 661):
                     d theta = C (a s - sqrt(a |theta|) sign theta) dp,  d beta = m (b s - beta) dp, and while beta lies
                     on its stagnation surface and leaves it  d R = m (Rsat - R) dp,  d r = h |d beta|, q follows
These are the laws of cpp/material/kinematic.hpp for von Mises, without their error of an increment.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray

STEPS = 100
"""Steps of a branch, denser where it begins."""


@dataclass
class State:
    """Where sets of parameters are after some branches; shapes (k,) of k sets, back stresses (parts, k)."""

    strain: FloatArray
    stress: FloatArray
    plastic: FloatArray
    """Plastic strain, summed without sign."""
    back: FloatArray


Parameters = dict[str, FloatArray]
"""Parameters by name, (k,)."""
Advance = Callable[[Parameters, State, float, FloatArray], tuple[FloatArray, FloatArray]]
"""From parameters, state, sense and steps of plastic strain (n, k), to stress (n, k) and parts of the back stress (n,
parts, k) after each."""


def flow_stress(given: Parameters, plastic: FloatArray) -> FloatArray:
    """Return the isotropic flow stress [MPa]; a missing modulus is zero."""
    growth = (given["saturation_stress"] - given["yield_stress"]) * -np.expm1(-given["rate"] * plastic)
    return np.asarray(given["yield_stress"] + growth + given.get("modulus", np.zeros(1)) * plastic)


def advance_isotropic(given: Parameters, state: State, sense: float, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the stress along a branch."""
    stress = sense * flow_stress(given, state.plastic + grid)
    return stress, np.zeros((len(grid), 0, grid.shape[1]))


def advance_chaboche(given: Parameters, state: State, sense: float, grid: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return stress and back stresses along a branch, in closed form; gamma is positive."""
    parts = []
    for k in range(len(state.back)):
        end = sense * given[f"C{k + 1}"] / given[f"gamma{k + 1}"]
        parts.append(end + (state.back[k] - end) * np.exp(-given[f"gamma{k + 1}"] * grid))
    back = np.stack(parts, axis=1)
    return sense * flow_stress(given, state.plastic + grid) + back.sum(axis=1), back


def advance_yoshida_uemori(
    given: Parameters, state: State, sense: float, grid: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return stress and theta, beta, R, q, r along a branch: theta by the midpoint rule, the others in closed form."""
    Y, B, C, m, b, Rsat, h = (given[name] for name in ("yield_stress", "B", "C", "m", "b", "Rsat", "h"))
    theta, beta, R, q, r = state.back
    rows = []

    def move(at: FloatArray, grown: FloatArray) -> FloatArray:
        a = np.maximum(B + grown - Y, 0.0)
        return np.asarray(C * (a * sense - np.sqrt(a * np.abs(at)) * np.sign(at)))

    for step in np.diff(grid, axis=0, prepend=0.0):
        after = sense * b + (beta - sense * b) * np.exp(-m * step)
        outside = np.maximum(np.abs(after - q) - r, 0.0)
        share = np.minimum(outside / np.maximum(np.abs(after - beta), 1e-300), 1.0)
        grown = Rsat + (R - Rsat) * np.exp(-m * step * share)
        middle = theta + 0.5 * step * move(theta, R)
        theta = theta + step * move(middle, 0.5 * (R + grown))
        r = r + h * outside
        q = q + np.sign(after - q) * (1.0 - h) * outside
        beta, R = after, grown
        rows.append(np.stack([theta, beta, R, q, r]))
    back = np.stack(rows)
    return sense * Y + back[:, 0] + back[:, 1], back


def follow_branch(
    advance: Advance, given: Parameters, state: State, end: float, young: float, at: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return stresses at strains `at` (n,) on the way to the strain `end`, (n, k), and plastic strain up to there (k,).

    A branch begins with an elastic change of stress, which ends where the law yields in the other direction. The
    plastic strain is -1 of a branch that ends before.
    """
    sense = 1.0 if end > state.strain[0] else -1.0
    grid = space_steps(np.abs(end - state.strain))
    stress, _ = advance(given, state, sense, grid)
    strain = sense * (state.strain + (stress - state.stress) / young + sense * grid)
    found, reached = np.empty((len(at), grid.shape[1])), np.empty(grid.shape[1])
    for k in range(grid.shape[1]):
        known = np.concatenate([[sense * state.strain[k]], strain[:, k]])
        found[:, k] = np.interp(sense * at, known, np.concatenate([[state.stress[k]], stress[:, k]]))
        reached[k] = np.interp(sense * end, strain[:, k], grid[:, k], left=-1.0)
    return found, reached


def end_branch(advance: Advance, given: Parameters, state: State, end: float, young: float, p: FloatArray) -> State:
    """Return the state at the strain `end` of a branch whose plastic strain is p (k,); below 0: it is elastic."""
    sense = 1.0 if end > state.strain[0] else -1.0
    stress, back = advance(given, state, sense, space_steps(np.maximum(p, 0.0)))
    elastic = state.stress + young * (end - state.strain)
    return State(
        np.full(len(p), end),
        np.where(p < 0.0, elastic, stress[-1]),
        state.plastic + np.maximum(p, 0.0),
        np.where(p < 0.0, state.back, back[-1]),
    )


def space_steps(length: FloatArray) -> FloatArray:
    """Return plastic strains from 0 to the lengths (k,), denser at the start (n, k)."""
    return np.asarray(np.linspace(0.0, 1.0, STEPS + 1)[:, None] ** 2 * length)


@dataclass(frozen=True)
class CyclicLaw:
    """A law as the fit sees it."""

    keys: tuple[str, ...]
    parts: int
    """Number of back stresses and of what belongs to them."""
    advance: Advance

    def stress(
        self, given: FloatArray, ends: Sequence[float], strains: Sequence[FloatArray], young: float, start: float = 0.0
    ) -> list[FloatArray]:
        """Return the stress [MPa] at strains of each branch (n, k), for k sets of parameters (k, number of keys).

        ends: strains at which the branches turn; start: where the first one begins, without stress.
        """
        sets = len(given)
        named = dict(zip(self.keys, given.T, strict=True))
        state = State(np.full(sets, start), np.zeros(sets), np.zeros(sets), np.zeros((self.parts, sets)))
        rows = []
        for i, (end, at) in enumerate(zip(ends, strains, strict=True)):
            found, plastic = follow_branch(self.advance, named, state, end, young, at)
            rows.append(found)
            if i + 1 < len(ends):
                state = end_branch(self.advance, named, state, end, young, plastic)
        return rows


VOCE = ("yield_stress", "saturation_stress", "rate")
CYCLIC_LAWS = {
    "isotropic": CyclicLaw((*VOCE, "modulus"), 0, advance_isotropic),
    "chaboche_1": CyclicLaw((*VOCE, "C1", "gamma1"), 1, advance_chaboche),
    "chaboche_2": CyclicLaw((*VOCE, "C1", "gamma1", "C2", "gamma2"), 2, advance_chaboche),
    "yoshida_uemori": CyclicLaw(("yield_stress", "B", "C", "m", "b", "Rsat", "h"), 5, advance_yoshida_uemori),
}
"""Laws that can be identified, by the name that an option has."""
