# SPDX-License-Identifier: Apache-2.0
"""Runs by cycles of explicit dynamics: solids and stampings, on one mesh or several."""
