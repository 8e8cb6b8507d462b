# SPDX-License-Identifier: Apache-2.0
"""Conduction in single cells: derivative, conservation, lumped volumes; and the heat content of a material."""

import numpy as np
import pytest

from presswork import _core
from presswork.body.heat import Enthalpy
from presswork.model import Thermal

QUAD = np.array([[1.0, 0.2], [3.1, 0.0], [3.4, 2.2], [0.8, 1.9]])
TRI = QUAD[:3]
LOWER = np.array([[0, 0, 0], [2, 0.1, 0], [2.2, 1.5, 0.1], [0, 1.4, 0]], dtype=float)


def with_mid_sides(corners):
    return np.concatenate([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])


CELLS = {
    "tri3": TRI,
    "tri6": with_mid_sides(TRI),
    "quad4": QUAD,
    "quad8": with_mid_sides(QUAD),
    "quad9": np.concatenate([with_mid_sides(QUAD), [QUAD.mean(axis=0)]]),
    "hex8": np.concatenate([LOWER, LOWER * (0.9, 1.1, 1) + (0.1, 0, 1.3)]),
}
TABLE = np.array([[0.0, 50.0], [500.0, 30.0], [1000.0, 35.0]])


def conduct(name, temperature, *, axisymmetric=False, table=TABLE):
    """Return flow (nodes,) and its derivative (nodes, nodes) of one cell."""
    points = CELLS[name]
    n, width = len(points), _core.pack_width
    flow, matrix = np.zeros((1, n, width)), np.zeros((1, n, n, width))
    connectivity = np.arange(n, dtype=np.int32)[None]
    section = {"axisymmetric": axisymmetric, "depth": 1.0}
    failed = _core.conduct_heat(name, connectivity, points, temperature, table, **section, flow=flow, conduction=matrix)
    assert failed == -1
    return flow[0, :, 0], matrix[0, :, :, 0]


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("name", CELLS)
def test_flow_has_its_derivative_and_makes_no_heat(name, axisymmetric) -> None:
    temperature = np.random.default_rng(3).uniform(100, 450, len(CELLS[name]))
    flow, matrix = conduct(name, temperature, axisymmetric=axisymmetric)
    assert abs(flow.sum()) < 1e-12 * np.abs(flow).sum()
    for b in range(len(temperature)):
        step = np.zeros(len(temperature))
        step[b] = 1e-3
        change = conduct(name, temperature + step, axisymmetric=axisymmetric)[0]
        change = (change - conduct(name, temperature - step, axisymmetric=axisymmetric)[0]) / 2e-3
        assert matrix[:, b] == pytest.approx(change, rel=1e-6, abs=1e-6 * np.abs(matrix).max())
    even, _ = conduct(name, np.full(len(temperature), 321.0), axisymmetric=axisymmetric)
    assert np.abs(even).max() < 1e-10


@pytest.mark.parametrize("name", CELLS)
def test_linear_temperature_is_carried_exactly(name) -> None:
    """The heat that enters and leaves is k times the gradient: sum of flow x position = -k grad T V."""
    gradient = np.array([3.0, -2.0, 1.5])[: CELLS[name].shape[1]]
    flow, _ = conduct(name, CELLS[name] @ gradient, table=np.array([[0.0, 40.0]]))
    n = len(CELLS[name])
    volume = _core.lump_volumes(
        name, np.arange(n, dtype=np.int32)[None], CELLS[name], axisymmetric=False, depth=1.0
    ).sum()
    assert flow @ CELLS[name] == pytest.approx(40.0 * gradient * volume, rel=1e-12)


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("name", CELLS)
def test_lumped_volumes_are_positive_and_add_up(name, axisymmetric) -> None:
    points = CELLS[name]
    if axisymmetric and name == "hex8":
        return
    connectivity = np.arange(len(points), dtype=np.int32)[None]
    lumped = _core.lump_volumes(name, connectivity, points, axisymmetric=axisymmetric, depth=2.0)
    assert (lumped > 0).all()
    if name == "hex8":
        return
    x, y = (TRI if name.startswith("tri") else QUAD).T
    following = np.roll(np.arange(len(x)), -1)
    cross = x * y[following] - x[following] * y
    whole = np.pi / 3 * (cross * (x + x[following])).sum() if axisymmetric else cross.sum()
    assert lumped.sum() == pytest.approx(whole, rel=1e-12)


def test_a_cell_turned_inside_out_is_told() -> None:
    connectivity = np.array([[0, 3, 2, 1]], dtype=np.int32)
    flow = np.zeros((1, 4, _core.pack_width))
    section = {"axisymmetric": False, "depth": 1.0}
    found = _core.conduct_heat("quad4", connectivity, QUAD, np.zeros(4), TABLE, **section, flow=flow, conduction=None)
    assert found == 0


def test_heat_content_is_the_integral_of_the_specific_heat() -> None:
    thermal = Thermal(
        density=1.0,
        conductivity=TABLE,
        specific_heat=np.array([[20.0, 4.4e8], [700.0, 9e8], [1200.0, 6.5e8]]),
        latent_heat=8e10,
        transformation=(700.0, 760.0),
    )
    content = Enthalpy(thermal)
    at = np.linspace(-50.0, 1300.0, 27001)
    found, specific = content.find(at)
    between = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(at) * (specific[1:] + specific[:-1]))])
    assert found - found[0] == pytest.approx(between, rel=2e-4, abs=1e6)
    assert content.find(np.array([20.0]))[0][0] == 0.0
    assert np.diff(found).min() > 0


FILMS = {
    "tools": _core.HeatFilm.at_nodes(np.array([1, 3], dtype=np.int32), np.array([2.0, 3.0]), np.array([20.0, 300.0])),
    "convection": _core.HeatFilm.convection(np.array([1.0, 0.0, 2.0, 0.5]), TABLE, 20.0),
    "radiation": _core.HeatFilm.radiation(np.array([1.0, 0.0, 2.0, 0.5]) * 5.67e-11, 20.0),
    "flux": _core.HeatFilm.flux(np.array([1.0, 0.0, 2.0, 0.5])),
    "between": _core.HeatFilm.between(np.array([[0, 3], [1, 3]], dtype=np.int32), np.array([2.0, 3.0])),
}


@pytest.mark.parametrize("kind", FILMS)
def test_a_film_has_its_derivative(kind: str) -> None:
    temperature, step = np.array([150.0, 330.0, 480.0, 260.0]), 1e-4
    _, slope = FILMS[kind].evaluate(temperature)
    for a in range(4):
        ends = [FILMS[kind].evaluate(temperature + s * step * np.eye(4)[a])[0][a] for s in (-1, 1)]
        assert slope[a] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-6, abs=1e-9)


def test_heat_between_nodes_is_neither_made_nor_lost() -> None:
    power, _ = FILMS["between"].evaluate(np.array([150.0, 330.0, 480.0, 260.0]))
    assert power == pytest.approx([220.0, -210.0, 0.0, -10.0])


def test_a_column_takes_the_step_of_backward_euler() -> None:
    rng, dt = np.random.default_rng(1), 0.3
    capacity, between, before = rng.uniform(1, 2, 6), rng.uniform(1, 2, 5), rng.uniform(20, 300, (4, 6))
    still, answer = _core.HeatColumn(capacity, between).step(before, dt)
    difference = np.diff(np.eye(6), axis=0)
    matrix = np.diag(capacity / dt) + difference.T @ (between[:, None] * difference)
    assert still == pytest.approx(np.linalg.solve(matrix, (capacity / dt * before).T).T, rel=1e-13)
    assert answer == pytest.approx(np.linalg.inv(matrix)[0], rel=1e-12)


def test_a_tool_takes_what_it_touches_and_passes_from_what_the_surroundings_see() -> None:
    edges = np.array([[0, 1], [1, 2], [2, 3]], dtype=np.int32)
    areas = np.full((3, 2), 0.5)
    seen = areas.copy()
    touching, pressure, nodes, area, conductance = _core.find_touch(
        edges,
        areas,
        holds=np.array([True, True, False, False]),
        push=np.array([10.0, 10.0, 0.0, 0.0]),
        gap=np.array([0.0, 0.0, 0.5, 2.0]),
        conductance=np.array([[0.0, 1.0], [40.0, 5.0]]),
        width=1.0,
        seen=seen,
    )
    assert list(touching) == [True, False, False]
    assert pressure == pytest.approx([20.0, 20.0, 0.0, 0.0])
    passes = 0.75  # mean of 1 and 0.5
    part = sum(w / 2 * max(1 - (0.5 + 1.5 * (1 + s) / 2), 0) for s, w in ((-np.sqrt(0.6), 5 / 9), (0, 8 / 9)))
    assert list(nodes) == [0, 1, 2, 3]
    assert area == pytest.approx([0.5, 0.5 + 0.5 * passes, 0.5 * (passes + part), 0.5 * part])
    assert conductance == pytest.approx([3.0, (0.5 * 3.0 + 0.5 * passes) / (0.5 + 0.5 * passes), 1.0, 1.0])
    assert seen == pytest.approx(np.array([[0, 0], [0.125, 0.125], [0.5 * (1 - part)] * 2]))


def test_points_share_their_amounts_among_pairs_of_nodes() -> None:
    edges = np.array([[4, 5]], dtype=np.int32), np.array([[1, 2], [2, 3]], dtype=np.int32)
    shapes = np.array([[0.25, 0.75], [0.5, 0.5]]), np.array([[1.0, 0.0], [0.0, 1.0]])
    at = np.array([0, 0], dtype=np.int32), np.array([0, 1], dtype=np.int32)
    pairs, (sums,) = _core.sum_pairs(*at, *shapes, *edges, [np.array([8.0, 2.0])])
    found = {tuple(pair): amount for pair, amount in zip(pairs.tolist(), sums, strict=True) if amount}
    assert found == {(4, 1): 2.0, (5, 1): 6.0, (4, 3): 1.0, (5, 3): 1.0}
