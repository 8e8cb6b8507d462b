# SPDX-License-Identifier: Apache-2.0
"""How deep tools are in the surface of a sheet."""

from __future__ import annotations

from presswork.observe.contract import Measure, Observed, Observer


class SheetDepth(Observer):
    """The depth of every tool in a sheet, by its thickness at the start."""

    def measures(self, run: Observed) -> list[Measure]:
        """Return the depths."""
        return [
            Measure(
                "penetration",
                depth / (thickness := run.model.thickest),
                f"the tool {name} is {depth:.3g} mm deep in the surface of the sheet of {thickness:g} mm",
            )
            for name, depth in run.tool_depths().items()
        ]
