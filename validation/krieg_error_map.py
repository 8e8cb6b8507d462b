# SPDX-License-Identifier: Apache-2.0
"""Map the six integrators' error against the exact perfectly plastic answer of Krieg & Krieg (1977).

Run: python -m validation.krieg_error_map docs/img/krieg_error_map.png
"""

from __future__ import annotations

import sys

import matplotlib.pyplot as plt
import numpy as np

from tests.verification.test_krieg_exact import INTEGRATORS, angle_after, exact_angle


def main(path: str) -> None:
    """Draw angle error against psi0 and q for each integrator; print its mean and largest at q = 0.2, 1 and 5."""
    psi0, q = np.linspace(1, 90, 90), np.geomspace(0.02, 10, 120)
    grid_psi, grid_q = (g.ravel() for g in np.meshgrid(psi0, q))
    figure, axes = plt.subplots(2, 3, figsize=(11, 6.4), sharex=True, sharey=True, layout="constrained")
    for axis, integrator in zip(axes.flat, INTEGRATORS, strict=True):
        error = angle_after(integrator, grid_psi, grid_q)[0] - exact_angle(grid_psi, grid_q)
        shown = axis.contourf(
            psi0, q, error.reshape(len(q), -1), levels=np.arange(-20, 21, 2), cmap="RdBu_r", extend="both"
        )
        axis.set(yscale="log", title=integrator)
    for size in (0.2, 1.0, 5.0):
        for integrator in INTEGRATORS:
            at = np.full(psi0.shape, size)
            error = np.abs(angle_after(integrator, psi0, at)[0] - exact_angle(psi0, at))
            print(f"q = {size:4g}  {integrator:22s} mean {error.mean():7.3f}  largest {error.max():7.3f} degrees")
    figure.supxlabel("angle between stress and strain rate at the start [degrees]")
    figure.supylabel("increment size q = 2G |de| / R")
    figure.colorbar(shown, ax=axes, label="error of the angle after one increment [degrees]")
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1])
