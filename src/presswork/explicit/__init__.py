# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics: blocks of cells, their tools, energies and options."""
