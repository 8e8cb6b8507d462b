# SPDX-License-Identifier: Apache-2.0
"""Quantities of the results, computed from the state."""
