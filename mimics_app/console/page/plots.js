// Plots of the newest seconds: bounded columns, each with the smallest and largest value of its sixtieth of a second.

import uPlot from "./vendor/uPlot.esm.js";

const HEIGHT = 108;
const SECONDS = 10;
const COLUMNS = 60 * SECONDS;

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function axes(unit) {
  const common = { stroke: () => colour("--quiet"), grid: { stroke: () => colour("--line"), width: 1 }, ticks: { show: false }, font: "13px system-ui" };
  return [
    { ...common, size: 26, values: (_, ticks) => ticks.map((tick) => `${tick.toFixed(0)} s`) },
    { ...common, size: 54, label: unit, labelFont: "13px system-ui", labelSize: 18 },
  ];
}

/** A plot that follows its element's width. */
class Plot {
  constructor(element, title, unit, series, least, bands) {
    this.element = element;
    const options = {
      width: element.clientWidth || 400, height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: (_, low, high) => [high - SECONDS, high] }, y: { range: (_, low, high) => range(low, high, least) } },
      axes: axes(unit), series: [{}, ...series], bands,
    };
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", `${title}, ${unit}`);
    const caption = document.createElement("p");
    caption.className = "caption";
    caption.textContent = title;
    element.append(caption);
    this.plot = new uPlot(options, [[], ...series.map(() => [])], element);
    new ResizeObserver(() => this.plot.setSize({ width: element.clientWidth, height: HEIGHT })).observe(element);
  }
}

function range(low, high, least) {
  if (low === null || high === null || !Number.isFinite(low)) return [0, least];
  const margin = Math.max((high - low) * 0.1, 1e-3);
  if (low >= 0 && high < least) return [0, least];
  return [low >= 0 && low < high / 2 ? 0 : low - margin, high + margin];
}

/** Extremes of a value per column; drawn as a band. */
export class BandPlot extends Plot {
  constructor(element, title, unit, tone, scale = 1) {
    const line = { stroke: () => colour(tone), width: 1.5, points: { show: false }, spanGaps: false };
    super(element, title, unit, [line, line], 1, [{ series: [2, 1], fill: () => `${colour(tone)}66` }]);
    this.scale = scale;
    this.clear();
  }

  clear() {
    this.columns = [[], [], []];
    this.plot.setData(this.columns);
  }

  add(seconds, low, high) {
    const [times, lows, highs] = this.columns;
    if (times.length && seconds <= times[times.length - 1]) this.columns = [[], [], []];
    this.columns[0].push(seconds);
    this.columns[1].push(low * this.scale);
    this.columns[2].push(high * this.scale);
    if (this.columns[0].length > COLUMNS) for (const column of this.columns) column.splice(0, COLUMNS / 10);
  }

  draw() {
    this.plot.setData(this.columns);
  }
}

/** Samples of a body signal, with marks at its events (R peaks). */
export class SignalPlot extends Plot {
  constructor(element, title, unit, tone) {
    const line = { stroke: () => colour(tone), width: 1.5, points: { show: false } };
    const marks = { stroke: () => colour("--alarm"), width: 0, paths: () => null, points: { show: true, size: 9, fill: () => colour("--alarm") } };
    super(element, title, unit, [line, marks], 1e-3);
    this.times = [];
    this.values = [];
    this.events = [];
    this.capacity = 12000;
  }

  add(seconds, value) {
    this.times.push(seconds);
    this.values.push(value);
    if (this.times.length > this.capacity) {
      this.times.splice(0, this.capacity / 4);
      this.values.splice(0, this.capacity / 4);
    }
  }

  mark(seconds) {
    this.events.push(seconds);
    if (this.events.length > 60) this.events.shift();
  }

  draw() {
    const count = this.times.length;
    if (!count) return;
    const begin = this.times.findIndex((time) => time > this.times[count - 1] - SECONDS);
    const times = this.times.slice(begin);
    const values = this.values.slice(begin);
    const marks = new Array(times.length).fill(null);
    for (const event of this.events) {
      const at = times.findIndex((time) => time >= event);
      if (at > 0) marks[at] = values[at];
    }
    this.plot.setData([times, values, marks]);
  }
}
