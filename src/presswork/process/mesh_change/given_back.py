# SPDX-License-Identifier: Apache-2.0
"""How much of the volume that cells have lost a new mesh gives back."""

MOST_GIVEN_BACK = 1e-3
"""Part of the volume of a body that one new mesh gives back at most."""


def limit_lost(first: float, now: float) -> float:
    """Return the part of a volume that is lost and can be given back; both without their elastic part.

    >>> limit_lost(1.0, 0.9999) < MOST_GIVEN_BACK == limit_lost(1.0, 0.9)
    True
    """
    return min(max(first / now - 1.0, -MOST_GIVEN_BACK), MOST_GIVEN_BACK)
