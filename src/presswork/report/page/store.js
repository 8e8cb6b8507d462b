// SPDX-License-Identifier: Apache-2.0
// The state of the page: what is shown. Whoever changes it calls set; whoever shows it listens.

export class Store {
  #listeners = [];

  constructor(state, draw) {
    this.state = state;
    this.draw = draw;
  }

  listen(listener) {
    this.#listeners.push(listener);
  }

  /** Change the state, tell all listeners what has changed, and draw. */
  async set(changes) {
    Object.assign(this.state, changes);
    for (const listener of this.#listeners) listener(Object.keys(changes));
    await this.draw();
  }
}
