# SPDX-License-Identifier: Apache-2.0
"""The state stays on the device: what goes there and comes back, by the counts of the host build; the same bits."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
import pytest

from presswork import _core
from presswork.explicit import resident
from presswork.explicit.device import OLDEST
from presswork.explicit.resident import Traffic
from presswork.explicit.shells import ExplicitError, ExplicitShells
from tests.consistency import test_explicit_cup as cup
from tests.consistency.test_device import make_run

HANDFUL = 3_000
"""Bytes that may go to the device in a call of 20 cycles, which what drives the tools in each takes."""
LITTLE = 2_000
"""Bytes that may come back from it."""


def since(run: ExplicitShells, before: Traffic) -> Traffic:
    now = run.traffic
    return Traffic(*(new - old for new, old in zip(astuple(now), astuple(before), strict=True)))


def look(run: ExplicitShells, *names: str) -> None:
    for name in names:
        assert np.isfinite(getattr(run, name)).all()


@pytest.mark.parametrize("n", [8, 24])
def test_cycles_take_a_handful_of_numbers_over_the_bus_however_many_shells(n: int) -> None:
    """Forces and places of tools and the run's clock are known after each call, and energies for a few numbers more."""
    run = cup.draw(n=n, device="host")
    run.advance(20)
    for _ in range(3):
        before = run.traffic
        run.advance(20)
        assert np.isfinite(run.tools["punch"].force).all()
        run.energies()
        run.stable_step()
        moved = since(run, before)
        assert 0 < moved.sent < HANDFUL
        assert 0 < moved.fetched < LITTLE


def test_only_what_is_looked_at_is_taken_back_and_once() -> None:
    run = cup.draw(device="host")
    run.advance(20)
    nodes, shells = len(run.start), len(run.blocks[0].cells)
    before = run.traffic
    look(run, "position", "position")
    assert since(run, before).fetched == 8.0 * 4 * nodes
    before = run.traffic
    look(run, "velocity", "position")
    assert since(run, before).fetched == 8.0 * (8 + 6) * nodes
    before = run.traffic
    look(run, "thickness", "thickness")
    assert since(run, before).fetched == 8.0 * shells
    before = run.traffic
    look(run, "stress")
    assert since(run, before).fetched > 8.0 * 5 * 4 * shells
    before = run.traffic
    look(run, "stress", "thickness", "history")
    assert since(run, before).fetched == 0.0
    run.reset_reaction()
    assert since(run, before).sent == 0.0
    assert not run.reaction_impulse.any()


def test_looking_changes_no_bit() -> None:
    """A run that is looked at, dumped and changed to the same after every call, and one that is left alone."""
    looked, alone = (cup.draw(radius=1.0, device="host") for _ in range(2))
    for _ in range(6):
        looked.advance(50)
        alone.advance(50)
        cup.results(looked)
        looked.restore(looked.dump())
        assert looked.stable_step() == alone.stable_step()
    for a, b in zip(cup.results(looked), cup.results(alone), strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("changed", [False, True])
def test_what_was_kept_on_the_device_is_the_dump_of_then(changed: bool) -> None:
    """Also where the loop is changed meanwhile, which has then the state that it had."""
    run, plain = (cup.draw(radius=1.0, device="host") for _ in range(2))
    for each in (run, plain):
        each.advance(300)
    expected, give = plain.dump(), run.keep()
    assert give is not None
    run.advance(100)
    plain.advance(100)
    if changed:
        run.tools["punch"].position = run.tools["punch"].position
        plain.tools["punch"].position = plain.tools["punch"].position
        for a, b in zip(cup.results(run), cup.results(plain), strict=True):
            np.testing.assert_array_equal(a, b)
        run.advance(30)
    kept = give()
    assert set(kept) == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(kept[name], values, err_msg=name)


def test_a_run_that_does_not_fit_is_refused_before_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resident, "HOST_MEMORY", 1e5)
    run = cup.draw(device="host")
    with pytest.raises(ExplicitError, match=r'needs 0\.00\d+ GB .* 0\.0001 GB free.*: take precision = "single"'):
        run.find_contact()
    assert run.cycle == 0


def test_a_card_that_is_too_old_is_refused_with_the_way_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_core, "list_cuda_cards", lambda: ([("Old", OLDEST - 5, 8e9, 7e9)], ""))
    with pytest.raises(ExplicitError, match=r'Old is too old, .* 8.0 or more; or take device = "cpu"'):
        make_run("cuda")
