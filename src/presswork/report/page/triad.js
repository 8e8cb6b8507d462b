// SPDX-License-Identifier: Apache-2.0
// The axes in a corner of the stage.
import { Vector3 } from "./libraries/three.js";

const COLOURS = ["#b3261e", "#2e7d32", "#1b5e9e"];

/** Paint where the axes point. isMeridian: a section of radius and height. */
export function paintTriad(parent, camera, isMeridian) {
  let canvas = parent.querySelector(".triad");
  if (!canvas) {
    canvas = document.createElement("canvas");
    canvas.className = "triad";
    canvas.width = canvas.height = 128;
    canvas.setAttribute("aria-hidden", "true");
    parent.append(canvas);
  }
  const context = canvas.getContext("2d"), names = isMeridian ? ["r", "z", ""] : ["x", "y", "z"];
  context.clearRect(0, 0, 128, 128);
  context.font = "600 20px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  const axes = [0, 1, 2].map((i) => new Vector3(...[0, 1, 2].map((k) => (k === i ? 1 : 0))).transformDirection(camera.matrixWorldInverse));
  for (const i of [0, 1, 2].sort((a, b) => axes[a].z - axes[b].z)) {
    const { x, y } = axes[i];
    if (Math.hypot(x, y) < 0.05 || !names[i]) continue;
    context.strokeStyle = context.fillStyle = COLOURS[i];
    context.beginPath();
    context.moveTo(64, 64);
    context.lineTo(64 + 38 * x, 64 - 38 * y);
    context.stroke();
    context.fillText(names[i], 64 + 52 * x, 64 - 52 * y);
  }
}
