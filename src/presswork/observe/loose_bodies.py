# SPDX-License-Identifier: Apache-2.0
"""Bodies that nothing holds: where they were stopped, and since when."""

from __future__ import annotations

from presswork.observe.contract import History, Observed, Observer


class LooseBodies(Observer):
    """The bodies that a run has stopped. Their warnings come first: what follows may mean nothing."""

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return which bodies move without a hold."""
        return run.warn_of_loose()
