# SPDX-License-Identifier: Apache-2.0
"""Meshes that the program makes."""
