# SPDX-License-Identifier: Apache-2.0
"""The page of a run in a real browser: what it shows is what was computed, every control works, no error is heard."""

from __future__ import annotations

import io
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.tri import LinearTriInterpolator, Triangulation

from presswork import Case, run
from presswork.model import CellBlock, Mesh
from presswork.report import write_report
from presswork.results import Result, append_step, truncate_steps
from presswork.view.cells import triangulate
from tests.regression.browser import ATTACK, Page, open_report, share_browser, share_upset

browser, upset, page = share_browser, share_upset, open_report


def test_values_in_the_page_are_those_of_the_results(page: Page, upset: Result) -> None:
    step = len(upset.times) - 1
    for name in ("effective_stress", "stress_xy", "contact_pressure", "contact_status", "displacement"):
        script = "async ([step, name]) => [...await presswork.runs[0].values(step, presswork.runs[0].findField(name))]"
        values = upset.scalar(name, step)
        np.testing.assert_allclose(page.ask(script, [step, name]), values, atol=2e-5 * np.ptp(values))
    places = np.reshape(page.ask("async (step) => [...await presswork.runs[0].points(step)]", step), (-1, 2))
    np.testing.assert_allclose(places, upset.points(step), atol=1e-3)


def test_text_of_a_title_is_text(page: Page) -> None:
    assert page.tab.locator("h1").inner_text() == f"Upsetting {ATTACK}"
    assert page.tab.title().startswith("Upsetting </script>")


def test_largest_value_is_marked_where_it_is(page: Page, upset: Result) -> None:
    largest = int(np.argmax(upset.field("effective_stress")))
    middle = upset.points()[upset.mesh.blocks[0].connectivity[largest]].mean(axis=0)
    spot = page.ask("(place) => presswork.stage.viewer.project(place)", [*middle, 0.0])
    (mark,) = page.tab.locator(".mark", has_text="max").all()
    style = [mark.evaluate(f"(element) => parseFloat(element.style.{side})") for side in ("left", "top")]
    np.testing.assert_allclose(style, spot, atol=1.0)
    assert mark.inner_text() == f"max {upset.field('effective_stress').max():.4g}"


def test_pointer_reads_place_and_value(page: Page, upset: Result) -> None:
    cell = 20
    middle = upset.points()[upset.mesh.blocks[0].connectivity[cell]].mean(axis=0)
    x, y = page.ask("(place) => presswork.stage.viewer.project(place)", [*middle, 0.0])
    page.tab.locator("#canvas").hover(position={"x": x, "y": y})
    probe = page.tab.locator("#probe")
    probe.wait_for(state="visible")
    value, place = probe.inner_text().split("\n")
    assert value == f"effective stress: {upset.field('effective_stress')[cell]:.4g} MPa"
    radius, height = (float(word) for word in place.split() if word[0].isdigit())
    np.testing.assert_allclose([radius, height], middle, atol=0.05)


def test_slider_and_force_curve_are_linked(page: Page, upset: Result) -> None:
    label = page.tab.locator("#time-label")
    assert "stroke 9.00 mm" in label.inner_text()
    page.tab.locator("#time").focus()
    page.tab.keyboard.press("Home")
    page.settle()
    assert "stroke 0.00 mm" in label.inner_text()
    page.tab.get_by_role("tab", name="Curves").click()
    page.tab.locator(".u-over").first.click(position={"x": 150, "y": 100})
    page.settle()
    step = page.ask("() => presswork.store.state.step")
    assert 0 < step < len(upset.times) - 1
    script = "() => document.querySelector('#panel table tbody tr:nth-child(4) td:nth-child(2)').textContent"
    page.tab.wait_for_timeout(200)
    shown = float(page.ask(script).split()[0])
    row = np.abs(upset.history["time"] - upset.times[step]).argmin()
    assert shown == pytest.approx(upset.history["punch.stroke"][row], rel=1e-4)


def test_every_control_works_without_an_error(page: Page) -> None:
    for toggle in ("Mesh", "Smooth", "Isolines", "Flow lines", "Bands", "Min/max"):
        button = page.tab.get_by_role("button", name=toggle, exact=True)
        before = button.get_attribute("aria-pressed")
        button.click()
        page.settle()
        assert button.get_attribute("aria-pressed") != before
    for label in ("Field", "View", "Colours", "Range", "Tools", "Cut"):
        select = page.tab.get_by_label(label, exact=True)
        values = [option.get_attribute("value") for option in select.locator("option").all()]
        assert len(values) > 1
        for value in values:
            page.choose(label, value)
    page.tab.get_by_label("Place of the section plane").fill("0.3")
    for name in ("Fit", "Front", "Top", "Side"):
        page.tab.locator("#toolbar").get_by_text(name, exact=True).click()
        page.settle()
    for tab in page.tab.get_by_role("tab").all():
        tab.click()
        page.tab.wait_for_timeout(100)
        assert tab.get_attribute("aria-selected") == "true"
        assert page.tab.locator("#panel").inner_text().strip()


def test_flow_lines_pass_through_the_first_places_of_the_material(page: Page, upset: Result) -> None:
    """Dark lines where the initial radius is half a distance and whole ones more; none without the toggle."""
    names = ("plain", "flow")
    page.press("Mesh")
    pictures = {}
    for name in names:
        picture = page.tab.locator("#canvas").screenshot()
        image = pytest.importorskip("PIL.Image").open(io.BytesIO(picture)).convert("RGB")
        pictures[name] = np.asarray(image).astype(int).sum(axis=2)
        page.press("Flow lines")
    darker = (pictures["plain"] - pictures["flow"] > 60).mean()
    assert 0.01 < darker < 0.3
    shown = page.ask("() => presswork.runs[0].flow")
    extent = np.ptp(upset.mesh.points, axis=0)
    assert shown["low"][:2] == upset.mesh.points.min(axis=0).tolist()
    assert extent / shown["apart"][:2] == pytest.approx(np.rint(20 * extent / extent.max()))


def test_turned_section_is_drawn_in_colours_of_its_values(page: Page) -> None:
    """Blue-violet where the stress is least, yellow where it is largest: viridis from end to end."""
    for view in ("section", "revolved"):
        page.choose("View", view)
        if view == "section":
            page.press("Mesh")  # lines off
        picture = page.tab.locator("#canvas").screenshot()
        image = pytest.importorskip("PIL.Image").open(io.BytesIO(picture)).convert("RGB")
        pixels = np.asarray(image).reshape(-1, 3).astype(int)
        coloured = pixels[np.ptp(pixels, axis=1) > 60]
        assert len(coloured) > 0.03 * len(pixels)  # the view fits the tools, too: the part takes 4 % of it
        red, green, blue = coloured.T
        assert ((blue > green + 30) & (red < 120)).any(), "low values"
        assert ((red > 140) & (green > 140) & (blue < 110)).any(), "high values"


def test_every_control_has_a_name_for_a_screen_reader(page: Page) -> None:
    session = page.tab.context.new_cdp_session(page.tab)
    nodes = session.send("Accessibility.getFullAXTree")["nodes"]
    kinds = {"button", "combobox", "slider", "tab", "image", "img", "textbox", "spinbutton", "tabpanel"}
    named = [node for node in nodes if not node.get("ignored") and node["role"]["value"] in kinds]
    assert len(named) > 15
    assert not [node["role"]["value"] for node in named if not node.get("name", {}).get("value")]


@pytest.fixture(scope="module")
def finer(upset: Result, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The same upsetting on a finer mesh."""
    case = Case.from_toml(upset.folder / "case.toml", overrides=["workpiece.mesh.cells=[10,10]"])
    return run(case, tmp_path_factory.mktemp("finer") / "fine").result


def test_difference_of_a_run_with_itself_is_zero(browser: Any, upset: Result) -> None:
    page = Page(browser, write_report([upset, upset], upset.folder / "both.html"))
    for field in ("effective_stress", "contact_pressure"):
        page.choose("Field", field)
        page.choose("Runs", "difference")
        assert page.ask("() => Math.max(...presswork.stage.values[0].raw.map(Math.abs))") < 1e-3
    assert not page.errors
    page.tab.close()


def test_difference_of_two_meshes_is_that_of_the_fields_at_the_same_place(
    browser: Any, upset: Result, finer: Result
) -> None:
    """Displacement is smooth, so that means at nodes of two meshes differ by what the solutions do."""
    page = Page(browser, write_report([upset, finer], upset.folder / "both.html"))
    assert page.ask("() => presswork.stage.viewer.views.length") == 2
    page.choose("Field", "displacement_x")
    page.choose("Runs", "overlay")
    assert page.ask("() => presswork.stage.viewer.views[0].length") == 2
    page.choose("Runs", "difference")
    found = np.array(page.ask("() => [...presswork.stage.values[0].raw]"))
    there = np.array([np.linalg.norm(finer.mesh.points - point, axis=1).argmin() for point in upset.mesh.points])
    same = np.linalg.norm(finer.mesh.points[there] - upset.mesh.points, axis=1) < 1e-9
    assert same.sum() >= 9, "corners, mid-sides and the middle"
    expected = upset.scalar("displacement_x") - finer.scalar("displacement_x")[there]
    np.testing.assert_allclose(found[same], expected[same], atol=2e-3)
    assert np.abs(found).max() < 0.5
    assert not page.errors
    page.tab.close()


def test_page_of_a_run_that_has_only_begun_opens(browser: Any, upset: Result, tmp_path: Path) -> None:
    """Neither summary nor history are there yet, and one step is saved."""
    shutil.copy(upset.folder / "results.vtkhdf", tmp_path)
    truncate_steps(tmp_path / "results.vtkhdf", 1)
    page = Page(browser, write_report(Result(tmp_path)))
    assert page.tab.locator("#status").inner_text() == "not finished"
    for tab in page.tab.get_by_role("tab").all():
        tab.click()
        page.tab.wait_for_timeout(100)
    assert page.tab.locator("#time").is_disabled()
    assert not page.errors
    page.tab.close()


def test_page_fits_a_telephone(browser: Any, upset: Result) -> None:
    page = Page(browser, write_report(upset), 390, 844)
    assert page.ask("() => document.documentElement.scrollWidth") <= 390
    assert not page.errors
    page.tab.close()


def test_section_plane_lays_open_the_field_inside(page: Page, upset: Result) -> None:
    """Of the revolved cylinder: at every corner of the cut, the value that the section has at its radius and height."""
    page.choose("Field", "displacement_y")
    page.choose("View", "revolved")
    page.choose("Cut", "x")
    page.tab.get_by_label("Place of the section plane").fill("0.7")
    page.settle()
    script = """() => { const cap = presswork.stage.scenes[0].images[0].children[3];
      const { position, value } = cap.geometry.attributes;
      return [cap.visible, [...position.array], [...value.array]]; }"""
    is_shown, places, values = page.ask(script)
    assert is_shown
    x, y, z = np.reshape(places, (-1, 3)).T
    step = len(upset.times) - 1
    np.testing.assert_allclose(x, x[0], atol=1e-3)
    net = Triangulation(*upset.points(step).T, triangulate(upset.mesh))
    inside = LinearTriInterpolator(net, upset.scalar("displacement_y", step))(np.hypot(x, z), y).filled(np.nan)
    known = np.isfinite(inside)
    assert known.sum() > 300
    assert np.quantile(np.abs(inside - values)[known], 0.99) < 0.01 * np.ptp(inside[known])
    page.choose("Cut", "")
    assert not page.ask("() => presswork.stage.scenes[0].images[0].children[3].visible")


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Result:
    """A quarter of a block of 8 x 8 x 4 mm in hexahedra, sheared, with a linear field at nodes and one in cells."""
    folder, n = tmp_path_factory.mktemp("block"), 4
    grid = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    a, b = slice(0, n), slice(1, n + 1)
    order = [(a, a, a), (b, a, a), (b, b, a), (a, b, a), (a, a, b), (b, a, b), (b, b, b), (a, b, b)]
    cells = np.stack([grid[place].ravel() for place in order], axis=1).astype(np.int32)
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    mesh = Mesh(points, (CellBlock("hex8_fbar", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    moved = np.stack([0.0 * points[:, 0], 0.0 * points[:, 0], 0.5 * points[:, 0]], axis=1)
    fields = {"effective_stress": points[cells].mean(axis=1) @ [1.0, 10.0, 100.0]}
    info = {"title": "block", "analysis": "solid", "symmetry": "xy"}
    append_step(folder / "results.vtkhdf", mesh, 0.0, {"displacement": moved}, fields, info=info)
    return Result(folder)


def test_cut_through_hexahedra_shows_the_field_inside(browser: Any, block: Result) -> None:
    """A section of known area, with the field that nodes and cells have there, in each image of a quarter."""
    page = Page(browser, write_report(block))
    page.choose("Field", "displacement_z")
    page.choose("Cut", "x")
    page.tab.get_by_label("Place of the section plane").fill("0.66")
    page.settle()
    script = """() => presswork.stage.scenes[0].images.map((image) => { const cap = image.children[3];
      const { position, value } = cap.geometry.attributes;
      return [image.scale.x, cap.visible, [...(position?.array ?? [])], [...(value?.array ?? [])]]; })"""
    caps = page.ask(script)
    assert len(caps) == 4
    at = -4.0 + 0.66 * 8.0
    for scale, is_shown, places, values in caps:
        assert is_shown == (scale > 0.0), "the plane x = 1.28 meets two of the four quarters"
        if not is_shown:
            continue
        corners = np.reshape(places, (-1, 3, 3))
        np.testing.assert_allclose(corners[..., 0], at, atol=1e-3)
        np.testing.assert_allclose(values, 0.5 * at, atol=1e-3)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert 0.5 * np.linalg.norm(normal, axis=1).sum() == pytest.approx(16.0, rel=1e-3)
    page.choose("Field", "effective_stress")
    page.press("Smooth")
    _, _, places, values = next(cap for cap in page.ask(script) if cap[1])
    middles = np.reshape(places, (-1, 3, 3)).mean(axis=1)
    middles[:, 2] -= 0.5 * middles[:, 0]
    np.testing.assert_allclose(values[::3], (np.floor(middles) + 0.5) @ [1.0, 10.0, 100.0], rtol=1e-4)
    assert page.ask("() => presswork.runs[0].fields[0].range") == pytest.approx([55.5, 388.5], rel=1e-4)
    page.close()


def test_large_sheet_is_turned_with_fewer_triangles(browser: Any, tmp_path: Path) -> None:
    """They cover the same area between nodes of the mesh; at rest all triangles are back."""
    n = 150
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(0.0, 100.0, n + 1)] * 2))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    points = np.stack([x, y, 0.0 * x], axis=1)
    mesh = Mesh(points, (CellBlock("shell4_mitc", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    fields = {"thickness": 1.0 + 0.01 * points[cells].mean(axis=1)[:, 0]}
    info = {"title": "large", "analysis": "shell"}
    append_step(tmp_path / "results.vtkhdf", mesh, 0.0, {"displacement": 0.0 * points}, fields, info=info)
    page = Page(browser, write_report(Result(tmp_path)))
    script = """(isCoarse) => { const { viewer, scenes } = presswork.stage; viewer.setCoarse(isCoarse);
      const { index, position } = scenes[0].body.geometry.toNonIndexed().attributes;
      return [scenes[0].body.geometry.index.count / 3, isCoarse ? [...position.array] : []]; }"""
    count, places = page.ask(script, True)
    assert 5_000 < count < 30_000
    corners = np.reshape(places, (-1, 3, 3))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert 0.5 * np.linalg.norm(normal, axis=1).sum() == pytest.approx(10_000.0, rel=0.05)
    assert page.ask(script, False)[0] == 2 * n * n
    page.close()


def test_runs_side_by_side_share_a_range_that_holds_both(browser: Any, upset: Result, tmp_path: Path) -> None:
    changes = ["workpiece.mesh.cells=[6,6]", "stages.0.tools.punch.stroke=3.0"]
    other = run(Case.from_toml(upset.folder / "case.toml", overrides=changes), tmp_path / "short").result
    page = Page(browser, write_report([other, upset], tmp_path / "both.html"))
    page.choose("Field", "displacement_y")
    low, high = page.ask("() => presswork.stage.legend.full")
    assert low == pytest.approx(-9.0, rel=1e-3), "the longer stroke, that of the second run"
    assert high == pytest.approx(0.0, abs=1e-3)
    page.close()


def test_values_that_are_nowhere_are_in_no_range_and_solid_tools_hide_nothing(page: Page) -> None:
    page.choose("Field", "gap")
    assert page.ask("() => presswork.stage.legend.full[1]") < 1e3
    page.choose("Field", "effective_stress")
    page.choose("View", "revolved")
    pictures = {}
    for tools in ("hidden", "transparent", "solid"):
        page.choose("Tools", tools)
        picture = page.tab.locator("#canvas").screenshot()
        pictures[tools] = np.asarray(pytest.importorskip("PIL.Image").open(io.BytesIO(picture)).convert("RGB"))
    part = np.ptp(pictures["hidden"].astype(int), axis=2) > 60
    assert part.sum() > 5000
    for tools in ("transparent", "solid"):
        changed = np.abs(pictures[tools].astype(int) - pictures["hidden"]).max(axis=2) > 12
        assert changed.any(), "the tools are drawn"
        assert changed[part].mean() < 0.02, "colours of the part are those of the legend, whatever the tools"


def test_top_view_has_x_to_the_right_and_y_upwards(browser: Any, block: Result) -> None:
    page = Page(browser, write_report(block))
    page.press("Look at the part from above")
    origin, x, y = (
        page.ask("(at) => presswork.stage.viewer.project(at)", at) for at in ([0, 0, 0], [1, 0, 0], [0, 1, 0])
    )
    assert x[0] > origin[0] + 5
    assert y[1] < origin[1] - 5
    page.close()
