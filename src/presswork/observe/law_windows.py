# SPDX-License-Identifier: Apache-2.0
"""How often and how far metal has flowed outside the window that its flow stress was fitted in."""

from __future__ import annotations

from typing import Any

from presswork.observe.contract import History, Observed, Observer


class LawWindows(Observer):
    """The windows of the materials."""

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return windows, what was reached and the shares outside."""
        return run.law_window().summarise(run.model.materials)

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return which laws were taken beyond their windows."""
        return run.law_window().warnings(run.model.materials)
