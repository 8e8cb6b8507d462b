// SPDX-License-Identifier: Apache-2.0
// Inflates the page's modules and starts the last of them. Addresses of modules exist only here, so imports are put in.
const addresses = {};
for (const element of document.querySelectorAll("script.module")) {
  const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  let source = await new Response(stream).text();
  source = source.replace(/\bfrom\s*"\.\/([^"]+)"/g, (_, name) => `from "${addresses[name]}"`);
  source += `\n//# sourceURL=presswork/${element.dataset.name}`;
  addresses[element.dataset.name] = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
}
await import(Object.values(addresses).at(-1));
