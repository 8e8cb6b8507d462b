// SPDX-License-Identifier: Apache-2.0
// A page that a server shows: takes up what a run writes while it computes, and stops the run or lets it go on.
import { make, makeButton } from "./elements.js";
import { ask } from "./unpack.js";

const PAUSE = 1000; // ms between two questions, at least; longer where an answer takes long
const WORDS = { running: "computing", paused: "paused", starting: "starting" };

/** Follow the runs of a served page. served: {generations}, one a run; showHead: shows title and status anew. */
export function follow({ generations }, runs, store, showHead) {
  const bars = runs.map((run) => new ProgressBar(run, () => wake()));
  document.querySelector("header").append(make("a", { href: "./", class: "back" }, "All runs"), ...bars.map((bar) => bar.box));
  let wake = () => {};
  const look = async (i) => {
    const run = runs[i], told = await ask(`news?${run.address}&steps=${run.steps.length}&rows=${countRows(run)}`);
    if (told.generation !== generations[i]) return location.reload();
    const isAtEnd = store.state.run === i && store.state.step === run.steps.length - 1;
    run.grow(told);
    bars[i].show(told.state);
    const changes = {};
    if (told.curves) changes.rows = countRows(run);
    if (told.steps.length && isAtEnd) changes.step = run.steps.length - 1;
    if (Object.keys(changes).length || told.steps.length) await store.set(changes);
    showHead();
    return told.state.is_running;
  };
  const go = async () => {
    for (;;) {
      const before = performance.now();
      let isRunning = false;
      try {
        for (let i = 0; i < runs.length; i++) isRunning = (await look(i)) || isRunning;
        document.getElementById("message").textContent = "";
      } catch {
        document.getElementById("message").textContent = "The server does not answer; it may have been closed.";
      }
      const pause = Math.max(isRunning ? PAUSE : 4 * PAUSE, 10 * (performance.now() - before));
      await new Promise((done) => { wake = done; setTimeout(done, document.hidden ? 10 * pause : pause); });
    }
  };
  go();
}

const countRows = (run) => run.curves.columns[0]?.values.n ?? 0;

/** How far a run is, and what can be done with it. */
class ProgressBar {
  constructor(run, onDone) {
    this.run = run;
    this.onDone = onDone;
    this.bar = make("progress", { max: "1", "aria-label": `Progress of ${run.name}` });
    this.words = make("span", { class: "soft" });
    const button = (word, action, title) => makeButton(word, () => this.#act(action), title);
    this.buttons = {
      pause: button("Hold", "pause", "Hold the computation; it stays in memory"),
      stop: button("Stop", "stop", "Stop after this increment, with a checkpoint from which it can go on"),
      resume: button("Go on", "resume", "Go on from where it was held, or from the checkpoint"),
    };
    this.box = make("div", { class: "group progress", role: "group", "aria-label": "Computation" }, this.bar, this.words, ...Object.values(this.buttons));
    this.box.hidden = true;
  }

  /** state: {word, fraction, text, is_running, can}. */
  show(state) {
    this.box.hidden = !state.can.length && !state.is_running;
    this.bar.value = state.fraction;
    this.words.textContent = `${WORDS[state.word] ?? state.word.replace("_", " ")}, ${Math.floor(100 * state.fraction)} %  ${state.text}`;
    for (const [name, button] of Object.entries(this.buttons)) button.hidden = !state.can.includes(name);
  }

  async #act(action) {
    try {
      await ask(`${action}?${this.run.address}`, { method: "POST" });
    } catch (error) {
      this.words.textContent = error.message;
    }
    this.onDone();
  }
}
