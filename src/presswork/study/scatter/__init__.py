# SPDX-License-Identifier: Apache-2.0
"""Scatter: what inputs that vary from part to part make of a process."""
