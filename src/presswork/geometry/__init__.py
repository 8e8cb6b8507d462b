# SPDX-License-Identifier: Apache-2.0
"""Curves, profiles, polygons and placement; no finite elements."""
