# SPDX-License-Identifier: Apache-2.0
"""The processes that a new case begins with: what each asks first, and how the answers become the keys of a case."""

from __future__ import annotations

from presswork.server.processes import forging, sheet
from presswork.server.processes.questions import Process

__all__ = ["PROCESSES", "Process"]

PROCESSES: dict[str, Process] = {process.key: process for process in (*forging.PROCESSES, *sheet.PROCESSES)}
"""Processes by the name of the starter that is filled in: server/starters/KEY.toml."""
