// SPDX-License-Identifier: Apache-2.0
// How the part, its lines and its tools are shaded.
import { DataTexture, DoubleSide, GLSL3, LinearFilter, NearestFilter, RawShaderMaterial, RGBAFormat, Vector3, Vector4, Color } from "./libraries/three.js";

const CLIP = `
uniform vec4 clip; uniform bool isClipped;
bool isCutOff(vec3 place) { return isClipped && dot(clip.xyz, place) > clip.w; }`;

const BODY_VERTEX = `
precision highp float;
in vec3 position; in vec3 normal; in float value; in vec3 origin;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
out vec3 vNormal, vPlace, vView, vOrigin; out float vValue;
void main() {
  vec4 place = modelMatrix * vec4(position, 1.0);
  vPlace = place.xyz; vValue = value; vOrigin = origin; vView = (viewMatrix * place).xyz;
  vNormal = mat3(viewMatrix) * mat3(modelMatrix) * normal;
  gl_Position = projectionMatrix * viewMatrix * place;
}`;

const BODY_FRAGMENT = `
precision highp float;
in vec3 vNormal, vPlace, vView, vOrigin; in float vValue;
uniform vec3 flowLow, flowApart; uniform bool hasFlow;
uniform sampler2D colours; uniform float low, high, bands; uniform bool isPlain, hasIsolines, isLit, isClosed; uniform vec3 plain;
out vec4 colour;
${CLIP}
void main() {
  if (isCutOff(vPlace)) discard;
  float part = (vValue - low) / max(high - low, 1e-30);
  float shown = bands > 0.0 ? (floor(clamp(part, 0.0, 0.9999) * bands) + 0.5) / bands : clamp(part, 0.0, 1.0);
  vec3 base = isPlain || abs(vValue) > 1e29 ? plain : texture(colours, vec2(shown, 0.5)).rgb;
  if (isClipped && isClosed && !gl_FrontFacing) { colour = vec4(0.62, 0.65, 0.7, 1.0); return; }
  if (hasIsolines && !isPlain) {
    float at = part * 10.0, width = fwidth(at);
    float line = 1.0 - smoothstep(0.6, 1.4, abs(fract(at - 0.5) - 0.5) / max(width, 1e-6));
    base = mix(base, vec3(0.08), 0.75 * line * step(width, 0.7));
  }
  if (hasFlow) {
    vec3 at = (vOrigin - flowLow) / flowApart, width = max(fwidth(at), 1e-6);
    vec3 line = (1.0 - smoothstep(0.5, 1.3, abs(fract(at) - 0.5) / width)) * step(width, vec3(0.7));
    base = mix(base, vec3(0.0, 0.0, 0.1), 0.85 * line.x);
    base = mix(base, vec3(0.35, 0.12, 0.0), 0.6 * max(line.y, line.z));
  }
  if (isLit) {
    vec3 flatNormal = normalize(cross(dFdx(vView), dFdy(vView)));
    if (dot(vNormal, vNormal) > 0.0 ? dot(vNormal, flatNormal) < 0.0 : !gl_FrontFacing) flatNormal = -flatNormal;
    vec3 n = normalize(vNormal + max(1.0 - length(vNormal), 0.0) * flatNormal);  // nodes of edges have no normal
    float light = 0.58 + 0.34 * abs(n.z) + 0.12 * (gl_FrontFacing ? n.y : -n.y);
    base *= min(light, 1.06);
  }
  colour = vec4(base, 1.0);
}`;

const LINE_VERTEX = `
precision highp float;
in vec3 position; uniform mat4 modelMatrix, viewMatrix, projectionMatrix; out vec3 vPlace;
void main() { vec4 place = modelMatrix * vec4(position, 1.0); vPlace = place.xyz; gl_Position = projectionMatrix * viewMatrix * place; }`;

const LINE_FRAGMENT = `
precision highp float;
in vec3 vPlace; uniform vec4 plain; out vec4 colour;
${CLIP}
void main() { if (isCutOff(vPlace)) discard; colour = plain; }`;

const TOOL_FRAGMENT = `
precision highp float;
in vec3 vNormal, vPlace; in float vValue; uniform vec4 plain; out vec4 colour;
${CLIP}
void main() {
  if (isCutOff(vPlace)) discard;
  float light = 0.62 + 0.38 * abs(normalize(vNormal).z);
  colour = vec4(plain.rgb * light, plain.a);
}`;

/** Uniforms of the section plane, shared by all that it cuts. */
export const clipping = { clip: { value: new Vector4(0, 0, 1, 0) }, isClipped: { value: false } };

export function makeBodyMaterial({ isLit, isClosed }) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: BODY_VERTEX, fragmentShader: BODY_FRAGMENT, side: DoubleSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    uniforms: {
      ...clipping, colours: { value: null }, low: { value: 0 }, high: { value: 1 }, bands: { value: 0 }, isPlain: { value: false },
      hasIsolines: { value: false }, hasFlow: { value: false }, flowLow: { value: new Vector3() }, flowApart: { value: new Vector3(1, 1, 1) }, isLit: { value: isLit }, isClosed: { value: isClosed }, plain: { value: new Color(0.78, 0.82, 0.87) },
    },
  });
}

/** Return the material of the face that the section plane lays open: colours of the body, neither cut nor lit. */
export function makeCapMaterial({ uniforms }) {
  const { clip, colours, low, high, bands, isPlain, hasIsolines, hasFlow, flowLow, flowApart, plain } = uniforms, no = { value: false };
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: BODY_VERTEX, fragmentShader: BODY_FRAGMENT, side: DoubleSide,
    uniforms: { clip, colours, low, high, bands, isPlain, hasIsolines, hasFlow, flowLow, flowApart, plain, isClipped: no, isLit: no, isClosed: no },
  });
}

export function makeLineMaterial(red, green, blue, opacity = 1) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: LINE_VERTEX, fragmentShader: LINE_FRAGMENT, transparent: opacity < 1,
    uniforms: { ...clipping, plain: { value: new Vector4(red, green, blue, opacity) } },
  });
}

export function makeToolMaterial(red, green, blue) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: BODY_VERTEX, fragmentShader: TOOL_FRAGMENT, side: DoubleSide, transparent: true, depthWrite: false,
    uniforms: { ...clipping, plain: { value: new Vector4(red, green, blue, 0.25) } },
  });
}

/** Return a scale's pixels as a texture; of zones with hard edges. */
export function makeTexture(pixels, isHard) {
  const texture = new DataTexture(pixels, pixels.length / 4, 1, RGBAFormat);
  texture.magFilter = texture.minFilter = isHard ? NearestFilter : LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
