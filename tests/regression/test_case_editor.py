# SPDX-License-Identifier: Apache-2.0
"""Cases set up in a real browser: a newcomer's cup, every kind of case and every key, problems at their fields."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from presswork.case import json_schema
from presswork.case.kinds import KINDS
from presswork.examples import copy_example, list_examples
from presswork.server.http import Server
from tests.regression.browser import Person, Tab, serve_folder, share_browser

browser, site = share_browser, serve_folder


def test_problems_stand_at_their_fields(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("upsetting_q4", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=upsetting_q4.toml")
    person = Person(page)
    person.type("materials.steel.poisson", "0.7")
    person.wait()
    field = page.tab.locator('[data-key="materials.steel.poisson"]')
    assert field.get_attribute("aria-invalid") == "true"
    assert "0.5" in page.tab.locator('.field:has([data-key="materials.steel.poisson"]) .fault').inner_text()
    assert page.tab.get_by_role("button", name="Save and run").is_disabled()
    person.type("materials.steel.poisson", "0.3")
    person.wait()
    assert page.tab.locator("#problems li").count() == 0
    assert page.tab.get_by_role("button", name="Save and run").is_enabled()
    page.close()
    assert tomllib.loads((tmp_path / "upsetting_q4.toml").read_text())["materials"]["steel"]["poisson"] == 0.3


@pytest.mark.parametrize("name", ["upsetting_q4", "square_cup", "forging_flash", "billet_cooling", "flat_bar"])
def test_every_key_of_an_example_has_a_field_with_its_value(
    browser: Any, site: Server, tmp_path: Path, name: str
) -> None:
    path = copy_example(name, tmp_path)
    before = path.read_text(encoding="utf-8")
    page = Tab(browser, f"{site.address}edit?case={name}.toml")
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    shown = page.tab.evaluate("() => [...document.querySelectorAll('[data-key]')].map((one) => one.dataset.key)")
    for key in list_keys(tomllib.loads(before)):
        assert any(key == one or one.startswith(f"{key}.") or key.startswith(f"{one}.") for one in shown), key
    page.tab.get_by_role("button", name="Text", exact=True).click()
    assert page.tab.get_by_label("Case file as text").input_value() == before, (
        "what was not changed is kept to the letter"
    )
    page.close()


def list_keys(data: Any, before: str = "") -> Iterator[str]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from list_keys(value, f"{before}.{key}" if before else key)
    elif isinstance(data, list) and data and all(isinstance(one, dict) for one in data):
        for i, value in enumerate(data):
            yield from list_keys(value, f"{before}.{i}")
    else:
        yield before


def test_all_examples_are_offered_behind_a_fold_and_found_by_a_word(browser: Any, site: Server) -> None:
    page = Tab(browser, f"{site.address}new")
    shown = page.tab.locator("#examples button")
    assert shown.count() == len(list_examples())
    assert not shown.first.is_visible()
    page.tab.get_by_text("All examples").click()
    page.tab.get_by_label("Search").fill("hammer")
    assert page.tab.locator("#examples li:visible").all_inner_texts() == [
        "Hammer forging of AA6082 in four blows\nhammer_forging"
    ]
    page.close()


def test_a_mesh_without_kind_is_shown_as_what_it_is(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("hot_upsetting", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=hot_upsetting.toml")
    assert page.tab.locator('[data-key="workpiece.mesh.kind"]').input_value() == "rectangle"
    page.close()


def test_settings_are_grouped_in_words_of_a_designer(browser: Any, site: Server, tmp_path: Path) -> None:
    """Every key of the case stands in the group that a designer looks in; a search leaves out groups without a hit."""
    copy_example("square_cup", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=square_cup.toml")
    heads = page.tab.locator("section.group > h2")
    groups = ["Job", "Part and material", "Tools and press", "Process", "Results and limits", "Accuracy"]
    assert heads.all_inner_texts() == groups
    script = "(key) => document.querySelector(`[data-key^='${key}']`).closest('section').querySelector('h2').innerText"
    for key, group in {"blank.thickness": 1, "tools.punch": 2, "stages.0": 3, "materials.steel": 1, "title": 0}.items():
        assert page.ask(script, key) == groups[group], key
    page.tab.get_by_label("Search", exact=True).fill("thickness")
    shown = [head.inner_text() for head in heads.all() if head.is_visible()]
    assert "Part and material" in shown
    assert "Accuracy" not in shown
    page.close()


FIND = """async (schema) => {
  const { classify, makeTable } = await import("./files/schema.js");
  const { Form } = await import("./files/form.js");
  const seen = new Set(), missing = [];
  let leaves = 0;
  const press = (box, name) => box.querySelector(`button[aria-label="${name}"]`)?.click();
  const visitTable = (node, tag, word) => {
    if (seen.has(node.title)) return;
    seen.add(node.title);
    const box = document.createElement("form");
    const form = new Form(box, { onChange() {}, onFile() {}, materials: [] });
    form.show(makeTable(node, schema, tag, word), { ...node, $defs: schema.$defs });
    for (const [name, one] of Object.entries(node.properties)) visitKey(box, one, name, node);
  };
  const visitKinds = ({ kinds, tag }) => Object.entries(kinds).forEach(([word, one]) => visitTable(one, tag, word));
  const visitItem = (item) => {
    const shape = classify(item, schema);
    if (shape.kind === "kinds") visitKinds(shape);
    else if (shape.kind === "table") visitTable(shape.node);
    else if (shape.kind === "named" || shape.kind === "list") visitItem(shape.item);
  };
  const visitKey = (box, one, name, node) => {
    const shape = classify(one, schema), has = (selector) => Boolean(box.querySelector(selector));
    const cells = `.cells [data-key^="${name}."]`, isMissing = (what) => missing.push(`${node.title}.${name}: ${what}`);
    leaves += 1;
    if (shape.kind === "table" || shape.kind === "kinds" || shape.kind === "named" || shape.kind === "list") {
      leaves -= 1;
      if (shape.cells) press(box, `Add a row to ${name.replaceAll("_", " ")}`);
      if (shape.cells && !has(cells)) isMissing("no cells");
      const words = ["Add", "Add to", "Add with settings to", "Remove"];
      const adders = words.map((word) => `button[aria-label="${word} ${name}"]`);
      if (!has(adders.join()) && !has(`[data-key^="${name}."]`)) isMissing("nothing adds it");
      if (shape.kind === "kinds") visitKinds(shape);
      else if (shape.kind === "table") visitTable(shape.node);
      else visitItem(shape.item);
    } else if (shape.kind === "cells") {
      if (!shape.isFixed) press(box, `Add a row to ${name.replaceAll("_", " ")}`);
      if (!has(cells)) isMissing("no cells");
    } else if (shape.kind === "choices") {
      if (!has(`input[type="checkbox"][data-key^="${name}."]`)) isMissing("no boxes");
    } else {
      if (!has(`input[data-key="${name}"], select[data-key="${name}"]`)) isMissing("no input");
      if (shape.cells) press(box, `Table for ${name}`);
      if (shape.cells && !has(cells)) isMissing("no table");
    }
  };
  visitTable(schema);
  const all = [schema, ...Object.values(schema.$defs)].filter((one) => one.properties).map((one) => one.title);
  return { leaves, missing, seen: [...seen], all };
}"""


@pytest.mark.parametrize("kind", list(KINDS))
def test_every_key_of_the_schema_has_an_input_in_the_form(browser: Any, site: Server, kind: str) -> None:
    """The form of every table is made, and an input, a table of cells or a button is found for each of its keys."""
    page = Tab(browser, f"{site.address}new")
    found = page.ask(FIND, json_schema(kind))
    page.close()
    assert found["missing"] == []
    assert set(found["all"]) <= set(found["seen"])
    assert found["leaves"] > 40


PASTE = """([key, text]) => {
  const data = new DataTransfer();
  data.setData("text", text);
  const cell = document.querySelector(`[data-key="${key}"]`);
  cell.dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true }));
}"""


def test_rows_are_added_pasted_and_removed_with_problems_at_their_cells(
    browser: Any, site: Server, tmp_path: Path
) -> None:
    copy_example("upsetting_q4", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=upsetting_q4.toml")
    person = Person(page)
    page.tab.locator('[data-key="materials.steel.hardening.law"]').select_option("table")
    person.press("Add a row to points")
    key = "materials.steel.hardening.points"
    page.ask(PASTE, [f"{key}.0.0", "strain\tstress\n0\t500\n0,1\t600\n0,2\t700\n0,3\t800\n"])
    person.wait()
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    person.press("Remove row 4 of points")
    person.type(f"{key}.1.1", "stiff")
    person.wait()
    cell = page.tab.locator(f'[data-key="{key}.1.1"]')
    assert cell.get_attribute("aria-invalid") == "true"
    assert "stress" in page.tab.locator(f'tr:has([data-key="{key}.1.1"]) + tr .fault').inner_text()
    assert page.tab.locator(f'[data-key="{key}.0.1"]').get_attribute("aria-invalid") is None
    person.type(f"{key}.1.1", "650 MPa")
    person.type("stages.0.tools.punch.direction.0", "0.0")
    person.press("Add a row to profile")
    person.type("tools.punch.profile.2.0", "32")
    person.type("tools.punch.profile.2.1", "16")
    page.tab.locator('[data-key="boundary.axis.fix.y"]').check()
    page.tab.locator('[data-key="boundary.axis.fix.y"]').uncheck()
    page.ask("() => document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    person.press("Table for stages 0 velocity")
    person.wait()
    assert page.tab.locator('[data-key^="stages.0.velocity.0."]').count() == 2
    person.press("One value for stages 0 velocity")
    person.type("stages.0.velocity", "")
    person.wait()
    assert page.tab.locator("#problems li").count() == 0, page.tab.locator("#problems").inner_text()
    person.press("Save")
    person.wait()
    page.tab.wait_for_function("() => document.getElementById('saved').textContent === 'saved'")
    page.close()
    data = tomllib.loads((tmp_path / "upsetting_q4.toml").read_text(encoding="utf-8"))
    assert data["materials"]["steel"]["hardening"]["points"] == [[0, 500], [0.1, "650 MPa"], [0.2, 700]]
    assert data["tools"]["punch"]["profile"] == [[0, 15], [30, 15], [32, 16]]
    assert data["boundary"]["axis"]["fix"] == ["x"]


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("0\t500\n0,1\t600", [["0", "500"], ["0.1", "600"]]),
        ("strain;stress\r\n0;500\r\n0,1;600\r\n", [["0", "500"], ["0.1", "600"]]),
        ("0, 500\n0.1, 600", [["0", "500"], ["0.1", "600"]]),
        ("0,500\n1,600", [["0", "500"], ["1", "600"]]),
        ("0 500\n0.1   600", [["0", "500"], ["0.1", "600"]]),
        ("0,0 500\n0,1 600", [["0.0", "500"], ["0.1", "600"]]),
        ("1\n2\n", [["1"], ["2"]]),
    ],
)
def test_what_is_pasted_is_read_as_it_was_written(browser: Any, site: Server, text: str, rows: list[list[str]]) -> None:
    page = Tab(browser, f"{site.address}new")
    read = "async (text) => { const { readBlock } = await import('./files/cells.js'); return readBlock(text); }"
    assert page.ask(read, text) == rows
    page.close()


def test_changes_are_undone_and_done_again(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("upsetting_q4", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=upsetting_q4.toml")
    person, field = Person(page), page.tab.locator('[data-key="materials.steel.poisson"]')
    undo, redo = (page.tab.get_by_role("button", name=word, exact=True) for word in ("Undo", "Redo"))
    assert undo.is_disabled()
    for text in ("0.31", "0.32"):
        person.type("materials.steel.poisson", text)
        person.wait()
    undo.click()
    person.wait()
    assert field.input_value() == "0.31"
    page.tab.keyboard.press("Control+z")
    person.wait()
    assert field.input_value() == "0.3"
    assert undo.is_disabled()
    assert page.tab.locator("#saved").inner_text() == "saved"
    redo.click()
    person.wait()
    redo.click()
    person.wait()
    assert field.input_value() == "0.32"
    assert redo.is_disabled()
    page.close()


def test_what_was_typed_outlives_a_closed_page(browser: Any, site: Server, tmp_path: Path) -> None:
    before = copy_example("upsetting_q4", tmp_path).read_text("utf-8")
    address = f"{site.address}edit?case=upsetting_q4.toml"
    page = Tab(browser, address)
    person = Person(page)
    person.type("materials.steel.poisson", "0.33")
    person.wait()
    page.close()
    assert (tmp_path / "upsetting_q4.toml").read_text("utf-8") == before, "nothing was saved"
    page = Tab(browser, address)
    field = page.tab.locator('[data-key="materials.steel.poisson"]')
    assert field.input_value() == "0.3"
    page.tab.get_by_role("button", name="Take them up").click()
    Person(page).wait()
    assert field.input_value() == "0.33"
    page.tab.get_by_role("button", name="Save", exact=True).click()
    page.tab.wait_for_selector("#saved:has-text('saved')")
    page.close()
    page = Tab(browser, address)
    assert page.tab.locator("#draft").is_hidden(), "what is saved is no draft any more"
    page.close()


def test_search_finds_keys_that_are_not_set_and_sets_their_tables(browser: Any, site: Server, tmp_path: Path) -> None:
    copy_example("upsetting_q4", tmp_path)
    page = Tab(browser, f"{site.address}edit?case=upsetting_q4.toml")
    page.tab.get_by_label("Search").fill("contact pressure")
    found = page.tab.locator("#found button")
    assert "limits.contact_pressure" in found.all_inner_texts()
    page.tab.get_by_role("button", name="limits.contact_pressure").click()
    Person(page).wait()
    assert page.tab.locator('[data-key="limits.contact_pressure"]').evaluate("(e) => e === document.activeElement")
    page.tab.get_by_label("Search").fill("remesh")
    assert "remesh" in found.all_inner_texts()
    page.close()
