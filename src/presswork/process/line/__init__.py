# SPDX-License-Identifier: Apache-2.0
"""Runs one after another: operations, springback, series of parts, and what they hand over."""
