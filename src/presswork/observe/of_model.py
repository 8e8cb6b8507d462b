# SPDX-License-Identifier: Apache-2.0
"""The observers of a model."""

from __future__ import annotations

from presswork.model import Model
from presswork.observe.contract import Observers
from presswork.observe.damage import DamagePeaks
from presswork.observe.die_fill import make_die_fill
from presswork.observe.draw_in import DrawIn
from presswork.observe.formability import FormabilityObserver
from presswork.observe.friction_tables import FrictionTables
from presswork.observe.heat import HeatOfBodies, HeatOfSheets
from presswork.observe.joints import Joints
from presswork.observe.law_windows import LawWindows
from presswork.observe.loose_bodies import LooseBodies
from presswork.observe.marked_points import MarkedPoints
from presswork.observe.overlap import Overlap
from presswork.observe.penetration import ToolCuts
from presswork.observe.pressure import Pressure
from presswork.observe.ram import RamObserver
from presswork.observe.reactions import Reactions
from presswork.observe.sheet_depth import SheetDepth
from presswork.observe.sheet_pressure import PressedSheet
from presswork.observe.slipping_rolls import SlippingRolls
from presswork.observe.wear import WearOfTools
from presswork.observe.weld_lines import WeldLines


def list_observers(model: Model) -> Observers:
    """Return what measures a run of a model; a new observer is a line here, and its columns follow in this order."""
    return Observers(
        [
            LooseBodies(),
            LawWindows(),
            HeatOfBodies(),
            HeatOfSheets(),
            RamObserver(),
            DamagePeaks(model),
            Overlap(),
            Reactions(model),
            make_die_fill(model),
            MarkedPoints(model),
            DrawIn(model),
            PressedSheet(model),
            ToolCuts(),
            Pressure(),
            FormabilityObserver(model),
            SheetDepth(),
            SlippingRolls(model),
            WeldLines(model),
            WearOfTools(model),
            FrictionTables(model),
            Joints(model),
        ]
    )
