// SPDX-License-Identifier: Apache-2.0
// The stage: camera, drawing on demand, views, what lies under the pointer.
import { OrbitControls, OrthographicCamera, Vector3, WebGLRenderer } from "./libraries/three.js";
import { clipping } from "./materials.js";

const DIRECTIONS = { iso: [1, -1.4, 0.9], front: [0, -1, 0], top: [0, -0.0001, 1], side: [1, 0, 0] };
const DIRECTIONS_OF_REVOLUTION = { iso: [0.9, 0.65, 1.3], front: [0, 0, 1], top: [0, 1, 0.0001], side: [1, 0, 0] };

const SLOW = 45; // ms a frame from which on the picture is coarser while it is turned

/** Say whether the browser draws by the processor alone. */
function isSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2"), info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

export class Viewer {
  constructor(canvas, onDraw) {
    this.canvas = canvas;
    this.onDraw = onDraw;
    this.views = []; // lists of scenes, a list a viewport from left to right
    this.camera = new OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
    const isSlow = isSoftware();
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSlow, alpha: true, preserveDrawingBuffer: true });
    this.ratio = isSlow ? 1 : Math.min(window.devicePixelRatio, 2);
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setClearColor(0xffffff, 0);
    this.renderer.autoClear = false;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => { this.isTurning = true; this.lastFrame = null; });
    this.controls.addEventListener("end", () => { this.isTurning = false; this.setCoarse(false); });
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.#setFrustum();
    this.draw();
  }

  /** Draw at the next frame. */
  draw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.drawNow();
    });
  }

  /** Draw with fewer pixels and triangles, or all again. */
  setCoarse(isCoarse) {
    const ratio = isCoarse ? 0.5 * this.ratio : this.ratio;
    if (ratio === this.renderer.getPixelRatio()) return;
    for (const scene of this.views.flat()) scene.setCoarse(isCoarse);
    this.renderer.setPixelRatio(ratio);
    this.resize();
  }

  drawNow() {
    const now = performance.now();
    if (this.isTurning && this.lastFrame && now - this.lastFrame > SLOW) this.setCoarse(true);
    this.lastFrame = now;
    const { part, height } = this.#layout();
    this.renderer.setScissorTest(true);
    this.renderer.setViewport(0, 0, this.canvas.parentElement.clientWidth, height);
    this.renderer.setScissor(0, 0, this.canvas.parentElement.clientWidth, height);
    this.renderer.clear();
    this.views.forEach((scenes, i) => {
      this.renderer.setViewport(i * part, 0, part, height);
      this.renderer.setScissor(i * part, 0, part, height);
      for (const scene of scenes) this.renderer.render(scene.scene, this.camera);
    });
    this.onDraw();
  }

  /** Show lists of run scenes, one list a viewport. */
  setViews(views) {
    this.views = views;
    this.#setFrustum();
    this.draw();
  }

  /** Look from a direction by name, at all of the first view. isFlat: a section, which only moves in its plane. */
  look(name, { isFlat, isRevolved }) {
    const { low, high } = this.#bounds(), middle = low.map((value, i) => 0.5 * (value + high[i]));
    const size = Math.hypot(...high.map((value, i) => value - low[i])) || 1;
    const direction = new Vector3(...(isFlat ? [0, 0, 1] : (isRevolved ? DIRECTIONS_OF_REVOLUTION : DIRECTIONS)[name])).normalize();
    this.camera.up.set(...(isFlat || isRevolved ? [0, 1, 0] : [0, 0, 1]));
    this.camera.position.copy(new Vector3(...middle).addScaledVector(direction, 2 * size));
    this.camera.near = -8 * size;
    this.camera.far = 12 * size;
    this.camera.zoom = 1;
    this.controls.target.set(...middle);
    this.controls.enableRotate = !isFlat;
    this.controls.mouseButtons.LEFT = isFlat ? 2 : 0;
    this.controls.touches.ONE = isFlat ? 1 : 0;
    this.camera.lookAt(...middle);
    this.camera.updateMatrixWorld();
    this.#fit(low, high);
    this.controls.update();
    this.draw();
  }

  /** Choose the frame so that the box of the part just fits. */
  #fit(low, high) {
    let width = 0, height = 0;
    for (let corner = 0; corner < 8; corner++) {
      const place = new Vector3(...low.map((value, i) => ((corner >> i) & 1 ? high[i] : value))).applyMatrix4(this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert());
      width = Math.max(width, Math.abs(place.x));
      height = Math.max(height, Math.abs(place.y));
    }
    this.frame = [1.18 * width || 1, 1.22 * height || 1];
    this.#setFrustum();
  }

  #setFrustum() {
    const [width, height] = this.frame ?? [1, 1], { part, height: pixels, beside } = this.#layout();
    const ratio = (part - beside) / pixels || 1, half = Math.max(height, width / ratio);
    Object.assign(this.camera, { left: -half * ratio, right: half * ratio + (beside * 2 * half) / pixels, top: half, bottom: -half });
    this.camera.updateProjectionMatrix();
  }

  /** Return width of a viewport and height of all [px], and what of the width is left free for the legend. */
  #layout() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement, n = Math.max(this.views.length, 1);
    const legend = document.body.classList.contains("drawing") ? 0 : width > 600 ? 150 : 112;
    return n === 1 ? { part: width, height, beside: legend } : { part: (width - legend) / n, height, beside: 0 };
  }

  #bounds() {
    const boxes = this.views.flat().map((scene) => scene.boundsWithTools());
    const pick = (name, find) => [0, 1, 2].map((i) => find(...boxes.map((box) => box[name][i])));
    return { low: pick("low", Math.min), high: pick("high", Math.max) };
  }

  /** Cut by a plane: what lies beyond `offset` along the normal goes; null: nothing is cut. */
  setClip(normal, offset) {
    clipping.isClipped.value = normal !== null;
    if (normal) clipping.clip.value.set(...normal, offset);
    this.draw();
  }

  /** Return where a place in space is on the stage [px], in viewport number `view`. */
  project(place, view = 0) {
    const { part, height } = this.#layout(), at = new Vector3(...place).project(this.camera);
    return [(view + 0.5 + 0.5 * at.x) * part, (0.5 - 0.5 * at.y) * height];
  }

  /** Return what lies under a place of the stage [px]: scene, triangle, weights of its corners, place; null: nothing. */
  pick(x, y) {
    const { part, height } = this.#layout(), view = Math.min(Math.floor(x / part), this.views.length - 1);
    const across = 2 * (x / part - view) - 1, up = 1 - (2 * y) / height;
    const from = new Vector3(across, up, -1).unproject(this.camera), to = new Vector3(across, up, 1).unproject(this.camera);
    const scene = this.views[view]?.[0];
    if (!scene?.positions) return null;
    let best = null;
    scene.images.forEach((image, i) => {
      const cut = scene.cuts?.[i], scale = [image.scale.x, image.scale.y, 1];
      const hits = [findHit(scene.positions, scene.shape.triangles, from, to, scale, clipping.isClipped.value)];
      if (cut) hits.push({ ...findHit(cut.corners, cut.triangles, from, to, scale, false), cut });
      for (const hit of hits) if (hit?.place && (!best || hit.way < best.way)) best = { ...hit, scene, view };
    });
    return best;
  }
}

/** Return the first triangle that the line between two places meets; isClipped: what is cut off does not count. */
function findHit(positions, triangles, from, to, scale, isClipped) {
  const start = [from.x * scale[0], from.y * scale[1], from.z], end = [to.x * scale[0], to.y * scale[1], to.z];
  const d = end.map((value, i) => value - start[i]), { clip } = clipping;
  const normal = [clip.value.x * scale[0], clip.value.y * scale[1], clip.value.z];
  let best = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const i = 3 * triangles[t], j = 3 * triangles[t + 1], k = 3 * triangles[t + 2];
    const ux = positions[j] - positions[i], uy = positions[j + 1] - positions[i + 1], uz = positions[j + 2] - positions[i + 2];
    const vx = positions[k] - positions[i], vy = positions[k + 1] - positions[i + 1], vz = positions[k + 2] - positions[i + 2];
    const px = d[1] * vz - d[2] * vy, py = d[2] * vx - d[0] * vz, pz = d[0] * vy - d[1] * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (determinant === 0) continue;
    const sx = start[0] - positions[i], sy = start[1] - positions[i + 1], sz = start[2] - positions[i + 2];
    const a = (sx * px + sy * py + sz * pz) / determinant;
    if (a < 0 || a > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const b = (d[0] * qx + d[1] * qy + d[2] * qz) / determinant;
    if (b < 0 || a + b > 1) continue;
    const way = (vx * qx + vy * qy + vz * qz) / determinant;
    if (way < 0 || (best && way >= best.way)) continue;
    const place = start.map((value, axis) => value + way * d[axis]);
    if (isClipped && normal[0] * place[0] + normal[1] * place[1] + normal[2] * place[2] > clip.value.w) continue;
    best = { way, triangle: t / 3, weights: [1 - a - b, a, b], place, scale };
  }
  return best;
}
