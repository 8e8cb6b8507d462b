// SPDX-License-Identifier: Apache-2.0
// Chooses what a new case begins with.
import { ask } from "./ask.js";
import { make } from "./elements.js";

const find = (id) => document.getElementById(id);

async function create(starter) {
  const name = find("name").value.trim() || starter;
  try {
    const { name: made } = await ask(`create?starter=${encodeURIComponent(starter)}&name=${encodeURIComponent(name)}`, { method: "POST" });
    location.href = `edit?case=${encodeURIComponent(made)}`;
  } catch (error) {
    find("message").textContent = error.message;
    find("name").focus();
  }
}

const makeCard = ({ name, title }) => make("li", {}, make("button", { type: "button", onclick: () => create(name) }, make("strong", {}, title), make("span", { class: "soft" }, name)));
const starters = await ask("starters");
find("starters").append(...starters.filter((one) => one.kind === "starter").map(makeCard));
find("examples").append(...starters.filter((one) => one.kind === "example").map(makeCard));
document.documentElement.dataset.ready = "1";
