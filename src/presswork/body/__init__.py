# SPDX-License-Identifier: Apache-2.0
"""Cells: solids and shells."""
