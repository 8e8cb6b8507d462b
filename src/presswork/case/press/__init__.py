# SPDX-License-Identifier: Apache-2.0
"""Presses: what drives the tools of a stage."""
