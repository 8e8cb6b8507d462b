// SPDX-License-Identifier: Apache-2.0
// The temperatures and strain rates of a job, roughly: what its material is looked at for.

const HOT = 300; // °C from which on a job is hot
const toNumber = (value, fallback) => {
  const found = parseFloat(String(value ?? ""));
  return Number.isFinite(found) ? found : fallback;
};
const round = (value) => Number(value.toPrecision(1));

/** Return {temperatures [°C], rates [1/s]} of a case's data. */
export function guessStates(data) {
  const start = toNumber(data.heat?.initial_temperature, 20), temperatures = start > HOT ? [start, start - 100, start - 200] : [start, start + 100, start + 200];
  const { size, height } = data.workpiece?.mesh ?? {}, tall = toNumber(Array.isArray(size) ? size.at(-1) : height, 10);
  const rates = (data.stages ?? []).flatMap((stage) => {
    const stroke = Math.max(0, ...Object.values(stage.tools ?? {}).map((motion) => toNumber(motion?.stroke, 0)));
    const speed = stage.velocity === undefined ? null : toNumber(stage.velocity, 0) * (/m\/s/.test(String(stage.velocity)) && !/mm\/s/.test(String(stage.velocity)) ? 1000 : 1);
    const press = stage.press && data.presses?.[stage.press], rpm = toNumber(press?.rpm, 0), mean = rpm ? (rpm / 60) * Math.PI * 0.25 * toNumber(press.stroke, 100) : null;
    const duration = speed || mean ? stroke / (speed || mean) : toNumber(stage.duration, 0);
    return stroke > 0 && duration > 0 ? [stroke / tall / duration] : [];
  });
  const rate = rates.length ? round(Math.max(...rates)) : 10;
  return { temperatures, rates: [rate, round(rate / 10)] };
}
