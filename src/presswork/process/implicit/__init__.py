# SPDX-License-Identifier: Apache-2.0
"""Runs by increments: solids, shells and stampings, on one mesh or several."""
