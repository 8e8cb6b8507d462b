# SPDX-License-Identifier: Apache-2.0
"""Map the error of one backward-Euler increment of the sheet laws against the same increment in 2000 parts.

Run: python -m validation.sheet_error_map docs/img/sheet_error_map.png

From tension at yield, strain increments (xx, yy) of up to six times the yield strain; error of the stress over the flow
stress. That increments in parts go to the rate equations is what tests/verification/test_sheet_law.py shows.
"""

from __future__ import annotations

import sys

import matplotlib.pyplot as plt
import numpy as np

from tests.problems.sheet_paths import follow
from tests.verification.test_sheet_law import YIELDS, YOUNG, make_law


def main(path: str) -> None:
    """Draw the error for each yield function; print its mean and largest."""
    size = np.linspace(0.0, 6.0, 61)
    flow = 140.0
    grid = np.stack(np.meshgrid(size, np.linspace(-6.0, 6.0, 121), indexing="xy"), axis=-1).reshape(-1, 2)
    figure, axes = plt.subplots(1, 4, figsize=(13, 4.4), sharex=True, sharey=True, layout="constrained")
    for axis, (name, function) in zip(axes, YIELDS.items(), strict=True):
        law = make_law(function, "linear", [flow, 0.0])
        n = len(grid)
        start = np.zeros((n, 3))
        start[:, 0] = flow / function.evaluate(np.array([[1.0, 0.0, 0.0]]))[0][0]
        strain = np.zeros((1, n, 3))
        strain[0, :, :2] = grid * flow / YOUNG
        whole, exact = (follow(law, strain, parts, stress=start, history=np.zeros((n, 1)))[0] for parts in (1, 2000))
        error = np.linalg.norm(whole - exact, axis=1) / np.linalg.norm(exact, axis=1)
        print(f"{name:12s} mean {100 * error.mean():5.2f} %, largest {100 * error.max():5.2f} %")
        shown = axis.contourf(
            size, np.linspace(-6.0, 6.0, 121), 100 * error.reshape(121, 61), levels=np.arange(0, 26, 2.5), extend="max"
        )
        axis.set(title=name)
    figure.supxlabel("strain increment along the tension, over the yield strain")
    figure.supylabel("across it")
    figure.colorbar(shown, ax=axes, label="error of the stress [%]")
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1])
