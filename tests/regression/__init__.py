# SPDX-License-Identifier: Apache-2.0
"""Whole runs: output, stopping and resuming, threads."""
