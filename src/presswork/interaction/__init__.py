# SPDX-License-Identifier: Apache-2.0
"""All that acts on nodes beside their own cells: tools, bodies on each other, loads, supports, inertia, drawbeads."""
