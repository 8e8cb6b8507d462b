# SPDX-License-Identifier: Apache-2.0
"""Print tables 1 and 2 of Cheng (1995), chapter 2: strain measures of a cube that is stretched, then turned twice.

Run: python examples/strain_measures.py
"""

from __future__ import annotations

import numpy as np

from presswork.post.strain_measures import measure_strains

EXTENSION, POISSON = 0.01, 0.5
ANGLES_DEG = (2.0, 5.0, 10.0)


def stretch_and_turn(extension: float, poisson: float, alpha: float, beta: float) -> np.ndarray:
    """Return F of an extension along x1, then rotations alpha about x3 and beta about x1 [rad]."""
    lateral = 1.0 - poisson * extension
    about_3 = np.array([[np.cos(alpha), -np.sin(alpha), 0], [np.sin(alpha), np.cos(alpha), 0], [0, 0, 1]])
    about_1 = np.array([[1, 0, 0], [0, np.cos(beta), -np.sin(beta)], [0, np.sin(beta), np.cos(beta)]])
    return np.asarray(about_1 @ about_3 @ np.diag([1.0 + extension, lateral, lateral]))


def print_tensor(name: str, tensor: np.ndarray) -> None:
    """Print a tensor, the rows under one another."""
    for row, label in zip(tensor, (name, "", ""), strict=True):
        print(f"  {label:28s}" + "".join(f"{v:12.6f}" for v in row))


def main() -> None:
    """Print both tables."""
    for degrees in ANGLES_DEG:
        angle = np.radians(degrees)
        m = measure_strains(stretch_and_turn(EXTENSION, POISSON, angle, angle))
        print(f"extension {EXTENSION}, lateral ratio {POISSON}, alpha = beta = {degrees:g} degrees")
        print_tensor("small strain", m.small)
        print_tensor("Green-Lagrange", m.green_lagrange)
        print_tensor("U - 1", m.stretch)
        print_tensor("V - 1", m.left_stretch)
        print_tensor("ln U", m.log)
        print_tensor("rotation R (thesis: R^T)", m.rotation)
        print_tensor("1 + spin (thesis: transposed)", np.eye(3) + m.spin)


if __name__ == "__main__":
    main()
