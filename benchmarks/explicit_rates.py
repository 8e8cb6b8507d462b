# SPDX-License-Identifier: Apache-2.0
"""What several rates of time would leave of the work of a refined blank: small shells at part of the others' step.

    python -m benchmarks.explicit_rates                 the square cup and the hemispherical punch, split twice
    python -m benchmarks.explicit_rates square_cup blank.element_size=1

At the rows of the draw each shell takes the largest step of h, 2 h, 4 h that it bears by itself, h the best of those at
most as long as the shortest of all; printed is the share of evaluations, weighted by shells and cycles. Nodes and
contact count as nothing.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.model import FloatArray
from presswork.process.explicit.stamping import ExplicitStamping

REFINED = {"square_cup": 4, "hemispherical_punch": 6}
RATES = (2, 3)


def share_left(step: FloatArray, rates: int) -> float:
    """Return the evaluations of so many rates over those of one, of shells that bear these steps (n,)."""
    shortest = step.min()
    smallest = shortest * 2.0 ** -np.linspace(0.0, 1.0, 41)[:-1]
    doubled = np.minimum(np.floor(np.log2(step / smallest[:, None]) + 1e-12), rates - 1)
    return float(((0.5**doubled).mean(axis=1) * shortest / smallest).min())


def main() -> None:
    """Print a line for each draw."""
    draws = {sys.argv[1]: sys.argv[2:]} if len(sys.argv) > 1 else {}
    for name, size in {} if draws else REFINED.items():
        draws[name] = [f"blank.element_size={size}", 'blank.refine={levels=2,angle="10 deg"}']
    for name, keys in draws.items():
        with tempfile.TemporaryDirectory() as folder:
            keys = ["explicit.ironing=false", "output.rows=40", *keys]
            run = ExplicitStamping(build_model(read_case(copy_example(name, Path(folder)), keys)), threads=1)
        work, left, small = 0.0, np.zeros(len(RATES)), []
        for row in run.advance():
            step = 2.0 / np.sqrt(run.shells.bound_frequencies())
            cost = len(step) * row.cycles
            work += cost
            left += cost * np.array([share_left(step, rates) for rates in RATES])
            small.append(float((step < 2.0 * step.min()).mean()))
        parts = ", ".join(f"{n} rates {share:.3f}" for n, share in zip(RATES, left / work, strict=True))
        print(f"{name}: {parts}; less than twice the shortest step: {min(small):.2f} to {max(small):.2f}")


if __name__ == "__main__":
    main()
