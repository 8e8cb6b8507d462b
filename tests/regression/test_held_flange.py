# SPDX-License-Identifier: Apache-2.0
"""What a stamping says of its holder, and of inertia, while it runs and at its end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, describe
from presswork.process.held_flange import summarise_holders, warn_of_holders
from presswork.recorder import StartError, run_model

AREA = np.pi * (33.0**2 - 19.2**2)
"""Of the flange beyond the holder's edge radius [mm2]."""


def cup(stroke: float = 1.5, holder: float | None = 5000.0, **changes: Any) -> StampingCase:
    """A quarter of a round cup of 34 mm from a blank of 66 x 0.8 mm; holder: force [N], or None for a gap."""
    ring = {"shape": "round", "diameter": 36.4}
    pushed = {} if holder is None else {"holder": {"force": holder}}
    return StampingCase.model_validate({
        "title": "round cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 66, "thickness": 0.8, "element_size": 3, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {"young": "210 GPa", "poisson": 0.3,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "tools": {"punch": {"kind": "punch", "shape": "round", "diameter": 34, "edge_radius": 5},
                  "die": {"kind": "die", "edge_radius": 5, **ring},
                  "holder": {"kind": "holder", "edge_radius": 1, **ring, **({"gap": 0.8} if holder is None else {})}},
        "stages": [{"name": "draw", "velocity": "5 m/s", "tools": {"punch": {"stroke": stroke}, **pushed}}],
        "output": {"rows": 20, "steps": 1},
        **changes,
    })  # fmt: skip


def history(lift: float = 0.0, force: float = 5000.0) -> dict[str, np.ndarray]:
    """Three rows of a draw in which the holder closes by 0.02 mm and is then lifted."""
    return {
        "time": np.array([1.0, 2.0, 3.0]),
        "stage": np.array(["draw"] * 3),
        "holder.stroke": np.array([0.0, 0.02, 0.02 - lift]),
        "die.stroke": np.zeros(3),
        "holder.force": np.array([0.0, force, 0.5 * force]),
    }


def test_a_holder_lifted_by_more_than_the_sheet_thickens_tells_of_wrinkles() -> None:
    model = build_model(cup())
    assert warn_of_holders(model, history(lift=0.2), thickest=0.95) == [], "0.05 mm are too little to speak of"
    (warning,) = warn_of_holders(model, history(lift=0.2), thickest=0.8)
    found = summarise_holders(model, history(lift=0.2), thickest=0.85)["wrinkles"]
    assert found["height_mm"] == pytest.approx(0.15)
    assert warning.startswith(
        "the flange has not stayed flat: it lifted holder by 0.2 mm (t = 3 s), 0.2 mm more than the"
    )


def test_a_sheet_squeezed_at_a_fixed_gap_is_told_with_its_pressure() -> None:
    model = build_model(cup(holder=None))
    assert warn_of_holders(model, history(lift=3.0, force=10e3), thickest=0.8) == [], "it stands, and presses 4.5 MPa"
    (warning,) = warn_of_holders(model, history(force=60e3), thickest=0.8)
    assert "squeezed below holder" in warning
    assert "leave it 0.88 to 0.96 mm" in warning
    pressure = float(warning.split(" MPa")[0].split()[-1])
    assert pressure == pytest.approx(60e3 / AREA, rel=0.08), "to a row of elements"


@pytest.mark.parametrize(("force", "wrinkles"), [(5000.0, False), (100.0, True)])
def test_a_cup_wrinkles_below_a_weak_holder_alone(force: float, wrinkles: bool, tmp_path: Path) -> None:
    summary = run_model(build_model(cup(holder=force)), tmp_path / "out", threads=1).result.summary
    assert [w.startswith("the flange has not stayed flat") for w in summary["warnings"]].count(True) == wrinkles


def test_the_pressure_on_the_flange_is_said_before_the_run(caplog) -> None:
    (line,) = (line for line in describe(build_model(cup())).splitlines() if "pushes" in line)
    pressure = float(line.split("at most ")[1].split()[0])
    assert pressure == pytest.approx(5000.0 / AREA, rel=0.08)
    assert caplog.messages == []
    build_model(cup(holder=5.0))
    assert "stages.0.tools.holder.force = 5: presses the flange with 0.00" in caplog.text


def test_a_holder_at_a_gap_that_is_pushed_too_is_refused() -> None:
    case = cup()
    tools = case.model_dump(exclude_unset=True)["tools"]
    tools["holder"]["gap"] = 1.0
    with pytest.raises(CaseError, match=r"tools\.holder\.gap = 1\.0: .*give the gap or the force"):
        build_model(cup(tools=tools))


def test_the_log_is_silent_on_inertia_until_the_sheet_is_formed(tmp_path: Path) -> None:
    """In its first rows every sheet has more kinetic than internal energy: that alone says nothing."""
    stages = [{"name": "draw", "velocity": "2 m/s", "tools": {"punch": {"stroke": 1.5}, "holder": {"force": 5000}}}]
    case = cup(stages=stages, output={"rows": 60, "steps": 1})
    result = run_model(build_model(case), tmp_path / "out", threads=1).result
    assert result.history["kinetic_energy"][0] > result.history["internal_energy"][0]
    log = (tmp_path / "out" / "run.log").read_text()
    assert log.count("warning") == len(result.summary["warnings"]), "those of the whole run, at its end"


def test_the_log_warns_of_a_blow(tmp_path: Path) -> None:
    """A strip of 20 x 8 x 0.8 mm, pulled by 1 mm at both ends at 50 m/s."""
    blank = {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel"}
    end = {"set": "right", "component": "x", "value": 1}
    stages = [{"name": "pull", "velocity": "50 m/s", "displacement": [end]}]
    case = cup(blank=blank | {"symmetry": ["x", "y"]}, tools={}, stages=stages)
    result = run_model(build_model(case), tmp_path / "out", threads=1).result
    assert "warning: kinetic energy" in (tmp_path / "out" / "run.log").read_text()
    assert any("kinetic energy" in w for w in result.summary["warnings"])


def test_damping_that_holds_the_sheet_as_in_tar_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StartError, match=r"explicit\.damping = 1e\+09 1/s: it would stop the part within 1e-09 s"):
        run_model(build_model(cup(explicit={"damping": 1e9})), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_flange_is_ironed_to_the_gap_of_its_holder_unless_the_case_leaves_that_out(tmp_path: Path) -> None:
    """A gap of the thickness: the flange keeps it within 0.5 %; else it thickens by 1.8 %, and sinks in."""
    thickest = {}
    for ironing in (True, False):
        case = cup(stroke=8.0, holder=None, explicit={"ironing": ironing})
        result = run_model(build_model(case), tmp_path / str(ironing), threads=1).result
        assert result.summary["status"] == "completed"
        assert abs(result.history["energy_error_percent"][-1]) < 0.2
        thickest[ironing] = result.field("thickness").max() / 0.8
    assert thickest[True] < 1.005
    assert thickest[False] > 1.015
