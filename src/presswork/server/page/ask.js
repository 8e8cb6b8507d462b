// SPDX-License-Identifier: Apache-2.0
// Questions to the server that sent the page.

/** Return what the server answers. Throws an Error with its message. */
export async function ask(address, options) {
  const response = await fetch(address, options), answer = await response.json();
  if (!response.ok) throw new Error(answer.error ?? response.statusText);
  return answer;
}

export const send = (address, data) => ask(address, { method: "POST", body: JSON.stringify(data) });

/** Copy a file beside a case; return its name there. */
export async function upload(name, file) {
  return (await ask(`upload?case=${encodeURIComponent(name)}&name=${encodeURIComponent(file.name)}`, { method: "POST", body: file })).name;
}

/** Return the address of the page of runs. */
export const addressOf = (names) => `run?${names.map((name) => `run=${encodeURIComponent(name)}`).join("&")}`;
