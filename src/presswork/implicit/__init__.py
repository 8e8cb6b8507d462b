# SPDX-License-Identifier: Apache-2.0
"""Increments in equilibrium: stepping, Newton's method, linear systems, arc length."""
