// Line charts as SVG, redrawn when their place changes its width.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 46, right: 12, top: 10, bottom: 34 };
const HEIGHT = 250;

const minus = (text) => String(text).replace(/-/g, "\u2212");

const RAISED = { "-": "\u207b", 0: "\u2070", 1: "\u00b9", 2: "\u00b2", 3: "\u00b3", 4: "\u2074", 5: "\u2075", 6: "\u2076", 7: "\u2077", 8: "\u2078", 9: "\u2079" };
const power = (exponent) => `10${[...String(exponent)].map((c) => RAISED[c]).join("")}`;

// Rounded for reading, powers of ten for the very small and large.
function readable(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "\u2013";
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e6)) {
    const [mantissa, exponent] = value.toExponential(Math.min(2, digits - 1)).split("e");
    return minus(`${mantissa}\u00a0\u00b7\u00a0`) + power(Number(exponent));
  }
  return minus(Number(value.toPrecision(digits)));
}

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

function node(parent, name, attributes = {}, text = null) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== null) made.textContent = text;
  parent.append(made);
  return made;
}

// About `count` round numbers inside [low, high].
function ticks(low, high, count) {
  const raw = (high - low) / count || 1;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * decade).find((s) => s >= raw * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}

function logTicks(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  const every = Math.max(1, Math.ceil((last - first) / 6));
  const found = [];
  for (let k = first; k <= last; k += every) found.push(10 ** k);
  return found;
}

const finite = (values) => values.filter((v) => v !== null && Number.isFinite(v));

/* A chart of lines over common or own abscissae.

   spec: {name, x: {label, values, integer, starts}, y: {label, log, low, high, format, ticks},
          series: [{name, values, x, color, dash, dots}], limits: [{at, text}], over: number, tip: (i) => html}
   Lines are interrupted before the indices x.starts, at which further runs begin.
   Methods: set(values per series), cursor(index or null). */
class LineChart {
  constructor(place, spec) {
    Object.assign(this, { place, spec, at: null });
    this.body = document.createElement("div");
    place.append(this.body);
    if (spec.series.length > 1 && spec.legend !== false) this.legend();
    this.tip = document.createElement("div");
    this.tip.className = "tip";
    this.tip.hidden = true;
    place.append(this.tip);
    new ResizeObserver(() => this.draw()).observe(place);
    this.draw();
  }

  legend() {
    const list = document.createElement("div");
    list.className = "legend";
    for (const { name, color, dash } of this.spec.series) {
      const item = document.createElement("span");
      const line = node(item, "svg", { viewBox: "0 0 22 10", "aria-hidden": "true" });
      node(line, "line", { x1: 0, x2: 22, y1: 5, y2: 5, style: `stroke:${color}`, "stroke-width": 2.2, "stroke-dasharray": dash || "" });
      item.append(name);
      list.append(item);
    }
    this.place.append(list);
  }

  set(values) {
    this.spec.series.forEach((series, i) => { series.values = values[i]; });
    this.draw();
  }

  cursor(index) {
    this.at = index;
    this.drawCursor();
  }

  abscissa(series) { return series.x || this.spec.x.values; }

  scales() {
    const { x, y, series, limits = [] } = this.spec;
    const xs = finite(series.flatMap((s) => this.abscissa(s)));
    let [xLow, xHigh] = [x.low ?? Math.min(...xs), x.high ?? Math.max(...xs)];
    if (xHigh === xLow) xHigh = xLow + 1;
    const ys = finite(series.flatMap((s) => s.values).concat(limits.map((l) => l.at)));
    let [low, high] = [y.low ?? Math.min(...ys), y.high ?? Math.max(...ys)];
    if (y.log) {
      const least = Math.min(...ys.filter((v) => v > 0));
      low = Math.max(least, high * 1e-9) / 1.6;
      high *= 1.6;
    } else {
      const pad = (high - low || Math.abs(high) || 1) * 0.06;
      low = y.low ?? low - pad;
      high = y.high ?? high + pad;
    }
    const width = Math.max(220, this.place.clientWidth), right = width - MARGIN.right, bottom = HEIGHT - MARGIN.bottom;
    const part = y.log ? (v) => Math.log(Math.max(v, low) / low) / Math.log(high / low) : (v) => (v - low) / (high - low);
    return {
      width, right, bottom, low, high, xLow, xHigh,
      x: (v) => MARGIN.left + ((v - xLow) / (xHigh - xLow)) * (right - MARGIN.left),
      y: (v) => bottom - part(v) * (bottom - MARGIN.top),
    };
  }

  draw() {
    const scale = (this.scale = this.scales());
    const svg = document.createElementNS(SVG, "svg");
    for (const [key, value] of Object.entries({ viewBox: `0 0 ${scale.width} ${HEIGHT}`, height: HEIGHT, role: "img", "aria-label": this.description() })) svg.setAttribute(key, value);
    this.drawAxes(svg, scale);
    const lines = this.clipped(svg, scale, "lines", 1), dots = this.clipped(svg, scale, "dots", 4);
    for (const series of this.spec.series) this.drawSeries(lines, dots, series, scale);
    this.mark = node(svg, "g");
    this.svg = svg;
    this.body.replaceChildren(svg);
    this.drawCursor();
    svg.addEventListener("pointermove", (event) => this.point(event));
    svg.addEventListener("pointerleave", () => { this.tip.hidden = true; });
  }

  // A group that shows nothing farther than `rim` outside the axes.
  clipped(svg, scale, name, rim) {
    const id = `${name}-${this.place.id || this.spec.name.replace(/\W+/g, "-")}`;
    node(node(svg, "clipPath", { id }), "rect", { x: MARGIN.left - rim, y: MARGIN.top - rim, width: scale.right - MARGIN.left + 2 * rim, height: scale.bottom - MARGIN.top + 2 * rim });
    return node(svg, "g", { "clip-path": `url(#${id})` });
  }

  drawAxes(svg, scale) {
    const { x, y, limits = [], over } = this.spec;
    const format = y.log ? (v) => power(Math.round(Math.log10(v))) : y.format || readable;
    for (const v of y.log ? logTicks(scale.low, scale.high) : ticks(scale.low, scale.high, 5)) {
      node(svg, "line", { class: "grid", x1: MARGIN.left, x2: scale.right, y1: scale.y(v), y2: scale.y(v) });
      node(svg, "text", { x: MARGIN.left - 6, y: scale.y(v) + 4, "text-anchor": "end" }, format(v));
    }
    const places = ticks(scale.xLow, scale.xHigh, Math.min(8, Math.max(3, scale.width / 60)));
    for (const v of places) {
      if (x.integer && !Number.isInteger(v)) continue;
      node(svg, "line", { class: "axis", x1: scale.x(v), x2: scale.x(v), y1: scale.bottom, y2: scale.bottom + 4 });
      node(svg, "text", { x: scale.x(v), y: scale.bottom + 16, "text-anchor": "middle" }, readable(v));
    }
    (x.starts || []).forEach((start, i) => {
      const at = scale.x((x.values[start - 1] + x.values[start]) / 2);
      node(svg, "line", { class: "run", x1: at, x2: at, y1: MARGIN.top, y2: scale.bottom });
      node(svg, "text", { x: at + 4, y: MARGIN.top + 10 }, `run ${i + 2}`);
    });
    node(svg, "text", { x: (MARGIN.left + scale.right) / 2, y: HEIGHT - 3, "text-anchor": "middle" }, x.label);
    if (over !== undefined && scale.high > over) {
      node(svg, "rect", { class: "over", x: MARGIN.left, width: scale.right - MARGIN.left, y: scale.y(scale.high), height: scale.y(over) - scale.y(scale.high) });
    }
    for (const { at, text } of limits) {
      if (at < scale.low || at > scale.high) continue;
      node(svg, "line", { class: "limit", x1: MARGIN.left, x2: scale.right, y1: scale.y(at), y2: scale.y(at) });
      if (text) node(svg, "text", { class: "limit-text", x: scale.right, y: scale.y(at) - 5, "text-anchor": "end" }, text);
    }
    node(svg, "path", { class: "axis", d: `M${MARGIN.left} ${MARGIN.top}V${scale.bottom}H${scale.right}` });
    if (scale.low < 0 && scale.high > 0 && !y.log) node(svg, "line", { class: "axis", x1: MARGIN.left, x2: scale.right, y1: scale.y(0), y2: scale.y(0) });
  }

  drawSeries(lines, dots, series, scale) {
    const xs = this.abscissa(series), { starts = [] } = this.spec.x;
    let path = "", down = false;
    series.values.forEach((v, i) => {
      if (starts.includes(i)) down = false;
      if (v === null || (this.spec.y.log && v <= 0)) { down = false; return; }
      path += `${down ? "L" : "M"}${scale.x(xs[i]).toFixed(2)} ${scale.y(v).toFixed(2)}`;
      down = true;
    });
    node(lines, "path", { class: "line", d: path, style: `stroke:${series.color}`, "stroke-dasharray": series.dash || "" });
    if (!series.dots) return;
    // hollow points last, so that no other point hides them
    for (const hollow of [false, true]) series.values.forEach((v, i) => {
      if (v === null || (this.spec.y.log && v <= 0) || this.isHollow(series, i) !== hollow) return;
      node(dots, "circle", { cx: scale.x(xs[i]), cy: scale.y(v), r: series.dots, style: `stroke:${series.color};stroke-width:1.6;fill:${hollow ? "var(--paper)" : series.color}` });
    });
  }

  isHollow(series, i) { return Boolean(series.hollow && series.hollow[i]); }

  drawCursor() {
    this.mark.replaceChildren();
    if (this.at === null) return;
    const { scale } = this, x = scale.x(this.spec.x.values[this.at]);
    node(this.mark, "line", { class: "cursor", x1: x, x2: x, y1: MARGIN.top, y2: scale.bottom });
    for (const series of this.spec.series) {
      const v = series.values[this.at];
      if (v === null || series.x || (this.spec.y.log && v <= 0)) continue;
      // a hollow point stays hollow
      const [fill, edge] = this.isHollow(series, this.at) ? ["var(--paper)", series.color] : [series.color, "var(--paper)"];
      node(this.mark, "circle", { cx: x, cy: scale.y(v), r: 4, style: `fill:${fill};stroke:${edge};stroke-width:1.5` });
    }
  }

  nearest(series, x) {
    const xs = this.abscissa(series);
    let best = 0;
    xs.forEach((v, i) => { if (Math.abs(v - x) < Math.abs(xs[best] - x)) best = i; });
    return best;
  }

  point(event) {
    const box = this.svg.getBoundingClientRect(), { scale, spec } = this;
    const px = ((event.clientX - box.left) / box.width) * scale.width, py = ((event.clientY - box.top) / box.height) * HEIGHT;
    const x = scale.xLow + ((px - MARGIN.left) / (scale.right - MARGIN.left)) * (scale.xHigh - scale.xLow);
    const rows = spec.series.map((series) => {
      const i = this.nearest(series, x), v = series.values[i];
      return { series, i, v, away: v === null ? Infinity : Math.abs(scale.y(v) - py) };
    });
    const shown = rows.length > 9 ? [...rows].sort((a, b) => a.away - b.away).slice(0, 3) : rows;
    const at = this.abscissa(shown[0].series)[shown[0].i];
    const lines = shown.map(({ series, i, v }) => `<i style="background:${series.color}"></i>${escaped(series.name)}: <b>${escaped((series.tip && series.tip(i)) || readable(v))}</b>`);
    this.tip.innerHTML = `${escaped(spec.x.label)} ${readable(at)}<br>${lines.join("<br>")}`;
    this.tip.hidden = false;
    const left = event.clientX - box.left;
    this.tip.style.left = `${left > box.width * 0.55 ? left - this.tip.offsetWidth - 14 : left + 14}px`;
    this.tip.style.top = `${Math.max(0, event.clientY - box.top - this.tip.offsetHeight / 2)}px`;
  }

  description() {
    const { name, series, x, y } = this.spec;
    const ends = series.slice(0, 9).map((s) => {
      const known = finite(s.values);
      return known.length ? `${s.name} from ${readable(known[0])} to ${readable(known[known.length - 1])}` : s.name;
    });
    return `${name}; ${y.label || ""} over ${x.label}: ${ends.join("; ")}`;
  }
}
