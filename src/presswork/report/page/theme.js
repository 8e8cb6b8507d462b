// SPDX-License-Identifier: Apache-2.0
// Light and dark pages: what the system prefers, or what the switch in the head has chosen; charts are told of a change.

const KEY = "presswork-theme", root = document.documentElement, preferred = matchMedia("(prefers-color-scheme: dark)");
const DARK = {
  "#1b5e9e": "#6fb1ee", "#c2571a": "#f0955a", "#2e7d4f": "#6cc794", "#7a4a9e": "#c09be0", "#a3333d": "#ef8a93", "#4d6b73": "#9dbdc6", "#8a6d1b": "#d9bb5c",
  "#5a5a5a": "#b4b4b4", "#1d222a": "#e6e9ee", "#20242b": "#e6e9ee", "#5b6470": "#a9b2be", "#a3222e": "#f2909a",
};

function recall() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null; // a page from a file may have no store
  }
}

function keep(theme) {
  try {
    localStorage.setItem(KEY, theme);
  } catch {
    // the choice then holds for this page
  }
}

export const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : preferred.matches);

/** Return a colour of lines as it is seen on the page's paper. */
export const tone = (colour) => (isDark() ? DARK[colour] ?? colour : colour);

/** Return a colour of the page by the name of its variable. */
export const readColour = (name) => getComputedStyle(root).getPropertyValue(name).trim();

/** Show a theme: light, dark, or what the system prefers (""). */
export function setTheme(theme) {
  theme ? (root.dataset.theme = theme) : delete root.dataset.theme;
  document.dispatchEvent(new Event("theme"));
}

function addSwitch(header) {
  const button = document.createElement("button"), show = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.title = `Show the page in ${isDark() ? "light" : "dark"} colours`;
  };
  button.type = "button";
  button.className = "theme";
  button.addEventListener("click", () => {
    const theme = isDark() ? "light" : "dark";
    keep(theme);
    setTheme(theme);
  });
  document.addEventListener("theme", show);
  show();
  header.append(button);
}

const chosen = recall(), header = document.querySelector("header");
if (chosen === "light" || chosen === "dark") root.dataset.theme = chosen;
preferred.addEventListener("change", () => document.dispatchEvent(new Event("theme")));
if (header) addSwitch(header);
