# SPDX-License-Identifier: Apache-2.0
"""Strain and stress paths at a material point, and rate equations integrated independently of the return mapping."""

from __future__ import annotations

import numpy as np

from presswork import _core

FREE = slice(1, 3)


def pull(law, strains, dt=1.0):
    """Drive total strain xx through `strains` with yy and xy free of stress; return stress xx, eqps and strains.

    The free strains are found by Newton with the consistent tangent. Shapes (n), (n), (n, 4: xx, yy, xy, zz).
    """
    stress, history = np.zeros((1, 3)), np.zeros((1, law.history_size))
    total, rows = np.zeros(4), []
    increment = np.zeros((1, 3))
    for change in np.diff(np.concatenate([[0.0], strains])):
        increment *= change / increment[0, 0] if increment[0, 0] else 0.0
        increment[0, 0] = change
        for _ in range(60):
            new, after, thickness, tangent, failed = law.update(increment, stress, history, dt=dt)
            assert not failed.any()
            if np.abs(new[0, FREE]).max() < 1e-9:
                break
            increment[0, FREE] -= np.linalg.solve(tangent[0, FREE, FREE], new[0, FREE])
        else:
            raise AssertionError("the free strains were not found")
        stress, history = new, after
        total = total + np.append(increment[0], thickness[0])
        rows.append((stress[0, 0], history[0, 0], *total))
    table = np.array(rows)
    return table[:, 0], table[:, 1], table[:, 2:]


def follow(law, path, increments, dt=1.0, stress=None, history=None):
    """Take points through the strain changes of path (segments, n, 3), each in equal increments; return the end."""
    n = path.shape[1]
    stress = np.zeros((n, 3)) if stress is None else stress
    history = np.zeros((n, law.history_size)) if history is None else history
    for change in path:
        for _ in range(increments):
            stress, history, _, _, failed = law.update(change / increments, stress, history, dt=dt / increments)
            assert not failed.any()
    return stress, history


def integrate_rates(function, flow, young, poisson, path, steps, C=(), gamma=()):
    """Integrate the rate equations of Chaboche's law over path (segments, n, 3) by Heun's rule; return stress, eqps.

    d stress = E : (d strain - dp n), d a_i = C_i xi/Y dp - gamma_i a_i dp, dp from f = Y staying so. After
    each step the stress is scaled back to the yield surface. flow(p) gives flow stress and slope.
    """
    plane = young / (1 - poisson**2)
    elastic = np.array([[plane, plane * poisson, 0], [plane * poisson, plane, 0], [0, 0, young / 2 / (1 + poisson)]])
    C, gamma = np.array(C), np.array(gamma)
    n = path.shape[1]
    stress, p, back = np.zeros((n, 3)), np.zeros(n), np.zeros((len(C), n, 3))

    def rates(stress, p, back, change):
        xi = stress - back.sum(axis=0)
        value, normal, _ = function.evaluate(xi)
        Y, slope = flow(p)
        move = C[:, None, None] * xi / Y[:, None] - gamma[:, None, None] * back
        pushed = change @ elastic
        bottom = (normal @ elastic * normal).sum(axis=1) + slope + (normal * move.sum(axis=0)).sum(axis=1)
        dp = np.maximum((normal * pushed).sum(axis=1) / bottom, 0.0)
        dp = np.where(value >= Y * (1 - 1e-5), dp, 0.0)
        return pushed - (dp[:, None] * normal) @ elastic, dp, dp[:, None] * move

    for segment in path:
        change = segment / steps
        for _ in range(steps):
            first = rates(stress, p, back, change)
            second = rates(stress + first[0], p + first[1], back + first[2], change)
            stress = stress + 0.5 * (first[0] + second[0])
            p = p + 0.5 * (first[1] + second[1])
            back = back + 0.5 * (first[2] + second[2])
            xi = stress - back.sum(axis=0)
            over = flow(p)[0] / function.evaluate(xi)[0]
            over = np.where(second[1] > 0, over, np.minimum(over, 1.0))
            stress = back.sum(axis=0) + over[:, None] * xi
    return stress, p


def integrate_yoshida_uemori(law: dict[str, float], young, targets, dp=1e-6, every=100):
    """Integrate Yoshida & Uemori's law for tension and compression by small steps in plastic strain.

    targets: total strains between which the load turns. Returns rows (strain, stress), one for `every` steps. law: Y,
    B, C, m, b, Rsat, h, Ea, xi, as in Yoshida & Uemori (2002), for one stress component.
    """
    Y, B, C, m, b, Rsat, h = (law[k] for k in ("Y", "B", "C", "m", "b", "Rsat", "h"))
    strain = stress = theta = beta = R = q = r = p = 0.0
    rows = [(0.0, 0.0)]
    for target in targets:
        s = 1.0 if target > strain else -1.0
        E = law["Ea"] + (young - law["Ea"]) * np.exp(-law["xi"] * p)
        strain += (s * Y + theta + beta - stress) / E
        stress = s * Y + theta + beta
        count = 0
        while s * (target - strain) > 0:
            a = B + R - Y
            d_theta = C * (a * s - np.sqrt(a * abs(theta)) * np.sign(theta)) * dp
            d_beta = m * (b * s - beta) * dp
            theta, beta = theta + d_theta, beta + d_beta
            beyond = abs(beta - q) - r
            if beyond > 0:
                R += m * (Rsat - R) * dp
                r += h * beyond
                q = beta - np.sign(beta - q) * r
            E = law["Ea"] + (young - law["Ea"]) * np.exp(-law["xi"] * p)
            p += dp
            new = s * Y + theta + beta
            strain += (new - stress) / E + s * dp
            stress = new
            count += 1
            if count % every == 0:
                rows.append((strain, stress))
        rows.append((strain, stress))
    return np.array(rows)


VON_MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
