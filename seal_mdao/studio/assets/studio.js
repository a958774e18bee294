// The live section: previews by the first-order changes of the last exact analysis, which the worker sends.

const place = (id) => document.getElementById(id);
const color = (i) => `var(--c${i % 8})`;
const FULL = 32000;   // what ShapeView takes for the end of a stress scale
const MOST_VALUES = 4;   // of a measure in the list of results
const KEY_STEP = 0.02;   // mm that an arrow key moves a handle

function floats(text) {
  if (text === null) return null;
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

const state = {
  scene: null, design: null, exact: null, rates: null, kept: [], status: null, frame: null, socket: null,
  dragging: false, change: 0, latencies: [], drawn: 0, counts: {},
};
window.studio = state;   // for tests

// ---- first order ----

// Values plus their changes; the parameters are the last axis of the rates.
function moved(base, rates, change) {
  const out = Float32Array.from(base), count = change.length;
  if (!rates) return out;
  change.forEach((value, p) => {
    if (value !== 0) for (let i = 0; i < out.length; i++) out[i] += rates[i * count + p] * value;
  });
  return out;
}

const difference = () => state.design.map((value, i) => value - state.exact.design[i]);
const isExact = () => state.exact && state.exact.design.every((value, i) => value === state.design[i]);

// The undeformed points, exact for every design: X = X_0 + sum_p b_p V_p.
function undeformed(design) {
  const { scene } = state, out = Float32Array.from(scene.undeformedAt), count = scene.velocityAt.length / out.length;
  for (let p = 0; p < count; p++) {
    if (design[p] === 0) continue;
    for (let i = 0; i < out.length; i++) out[i] += design[p] * scene.velocityAt[p * out.length + i];
  }
  return out;
}

// All that is drawn, of the present design.
function present() {
  const { exact, rates } = state, change = difference(), exactly = change.every((v) => v === 0);
  const of = (base, own) => (exactly ? base : moved(base, own, change));
  const frame = exact.frame, points = of(frame.pointsAt, rates && rates.pointsAt);
  return {
    exactly, points,
    poses: frame.poses.map((pose, i) => of(pose, rates && rates.posesAt[i])),
    ways: frame.ways.map((way, i) => of(way.flat(), rates && rates.waysAt[i])),
    pressure: frame.pressure.map((own, i) => ({ ...own, values: of(own.values, rates && rates.pressureAt[i]).map((v) => Math.max(v, 0)) })),
    curves: exact.curves.map((own, i) => ({
      ...own, force: of(own.force.flat(), rates && rates.forceAt[i]), along: of(own.along, rates && rates.alongAt[i]),
    })),
    measures: Object.fromEntries(Object.entries(exact.measures).map(([name, values]) => [name, of(values, rates && rates.measuresAt[name])])),
  };
}

function unpackRates(rates) {
  rates.pointsAt = floats(rates.points);
  for (const key of ["poses", "ways", "pressure", "force", "along"]) rates[`${key}At`] = rates[key].map(floats);
  rates.measuresAt = Object.fromEntries(Object.entries(rates.measures).map(([name, own]) => [name, floats(own)]));
}

// ---- pictures ----

const views = {}, charts = {};

function shapesOf(scene) {
  const scales = scene.colours.map((colours, i) => ({ name: scene.colours.length > 1 ? scene.materials[i] : "", top: 1, colours }));
  return { ...scene, length: 1, scales, watched: [] };
}

function rigid(profile, [x, y, angle], [u, v]) {
  const [px, py] = profile.pivot, [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [px + x + c * (u - px) - s * (v - py), py + y + s * (u - px) + c * (v - py)];
}

// x, y, cosine, sine of the origin of a profile's frame, as ShapeView takes them.
function placed(profile, pose) {
  const [x, y] = rigid(profile, pose, [0, 0]);
  return [x, y, Math.cos(pose[2]), Math.sin(pose[2])];
}

function drawShapes(now) {
  const { scene, exact } = state, made = undeformed(state.design);
  const boundary = new Float32Array(2 * scene.loops.reduce((sum, loop) => sum + loop.length, 0));
  scene.loops.flat().forEach((point, i) => boundary.set([made[2 * point], made[2 * point + 1]], 2 * i));
  const starts = scene.profiles.map((profile, i) => placed(profile, [...now.ways[i].slice(0, 3)]));
  const ghost = now.exactly ? null : { boundary: nominalBoundary() };
  views.made.draw({ boundary, profiles: scene.profiles, poses: starts }, ghost, "Undeformed section, with handles");
  const tops = exact.frame.tops, points = new Float32Array(now.points);
  for (let k = 0; k < points.length / 3; k++) points[3 * k + 2] = Math.min(FULL, Math.max(0, points[3 * k + 2] / tops[scene.regions[k]]) * FULL);
  views.pressed.shapes.scales.forEach((scale, i) => { scale.top = tops[i]; });
  const frame = { points, profiles: scene.profiles, poses: scene.profiles.map((profile, i) => placed(profile, now.poses[i])) };
  if (now.exactly) Object.assign(frame, { touching: exact.frame.touchingAt, marks: exact.frame.marks });
  drawScales();
  // one colour for each piece of the grid while it is a preview
  views.pressed.subdivide = now.exactly ? 2 : 1;
  views.pressed.draw(frame, null, `${now.exactly ? "Exact analysis" : "First-order preview"}: deformed section with von Mises stress at ${exact.frame.caption}`);
}

function nominalBoundary() {
  const { scene } = state, at = undeformed(state.exact.design), out = new Float32Array(2 * scene.loops.flat().length);
  scene.loops.flat().forEach((point, i) => out.set([at[2 * point], at[2 * point + 1]], 2 * i));
  return out;
}

function drawScales() {
  const tops = views.pressed.shapes.scales.map(({ top }) => top).join();
  if (place("scales").dataset.tops === tops) return;
  place("scales").dataset.tops = tops;
  const rows = views.pressed.shapes.scales.map(({ name, top, colours }) => {
    const row = document.createElement("div"), bar = document.createElement("i");
    row.className = "scale";
    bar.style.background = `linear-gradient(to right, ${colours.join(",")})`;
    row.append(name ? `${name}: 0` : "0", bar, `${readable(top)} kPa von Mises stress`);
    return row;
  });
  place("scales").replaceChildren(...rows);
}

function component(values, k) { return Array.from({ length: values.length / 2 }, (_, i) => values[2 * i + k]); }

function drawCharts(now) {
  const { kept, scene } = state, colours = [];
  const curves = [], add = (list, series) => list.push(series);
  now.curves.forEach((own, i) => {
    const name = now.curves.length > 1 ? own.name : "this design";
    add(curves, { name, x: [0, ...own.along], values: [own.initial[own.component], ...component(own.force, own.component)], color: color(i), dash: now.exactly ? "" : "5 3" });
    // estimated numerical error of the force at the end of the path, at the section of the file
    const error = state.errors && state.errors[`force_on_${own.name}`], end = own.force.length / 2 - 1;
    if (error && end >= 0) {
      const at = own.along[end], force = own.force[2 * end + own.component], half = error[own.component];
      add(curves, { name: `${name}, estimated numerical error`, x: [at, at], values: [force - half, force + half], color: color(i), dots: 2 });
    }
    // scatter of the tolerances to first order, at the last exact analysis
    const band = state.scatter && state.scatter[i];
    if (band) [["+", 2], ["−", -2]].forEach(([sign, k]) => add(curves, {
      name: `${name}, ${sign} 2 standard deviations of the tolerances`, x: [0, ...own.along],
      values: [own.initial[own.component], ...component(own.force, own.component).map((f, at) => f + k * band[at][own.component])], color: color(i), dash: "1 3",
    }));
  });
  const pressures = now.pressure.map((own, i) => ({ name: now.pressure.length > 1 ? own.name : "this design", x: own.arc, values: [...own.values], color: color(i), dash: now.exactly ? "" : "5 3", dots: 2 }));
  // travel and load steps have no common axis
  const words = now.curves.length ? now.curves[0].words : "";
  kept.forEach(({ name, curves: those, pressure }, i) => {
    those.slice(0, 1).filter((own) => own.words === words).forEach((own) => curves.push({ name, x: [0, ...own.along], values: [own.initial[own.component], ...own.force.map((f) => f[own.component])], color: color(i + 2), dash: "2 3" }));
    pressure.slice(0, 1).forEach((own) => pressures.push({ name, x: own.arc, values: own.values, color: color(i + 2), dash: "2 3" }));
  });
  chart("curve", { name: "Load-deflection curve", x: { label: words, values: [] }, y: { label: scene.force.unit }, series: curves });
  chart("pressure", { name: "True contact pressure", x: touched(now), y: { label: "kPa", low: 0 }, series: pressures });
  place("curve-unit").textContent = scene.force.unit;
  return colours;
}

// Abscissae along the part of the boundary that touches.
function touched(now) {
  const arcs = now.pressure.flatMap((own) => own.arc.filter((_, k) => own.values[k] > 0));
  const all = now.pressure.flatMap((own) => own.arc), found = arcs.length > 1 ? arcs : all, pad = 0.04 * (Math.max(...all, 1) - Math.min(...all, 0));
  return { label: "arc length (mm)", values: [], low: Math.min(...found) - pad, high: Math.max(...found) + pad };
}

// A chart keeps its axes while it is dragged, unless the curve leaves them.
function chart(id, spec) {
  const own = charts[id];
  if (!spec.series.length) { place(id).parentElement.hidden = true; return; }
  place(id).parentElement.hidden = false;
  const names = spec.series.map((s) => `${s.name}${s.color}`).join();
  if (own && own.names === names) {
    own.chart.spec = spec;
    own.chart.draw();
    return;
  }
  // an element of its own, with which the observer of its size goes
  const inside = document.createElement("div");
  place(id).replaceChildren(inside);
  charts[id] = { names, chart: new LineChart(inside, spec) };
}

// ---- numbers ----

function unitOf(name) {
  const found = state.scene.measures.find((own) => own.name === name);
  return found ? unitText(found.unit) : "";
}

const unitText = (unit) => unit.replace("**2", "²").replace("**3", "³").replace(/\*/g, " ");
const spoken = (name) => name.replace(/_/g, " ");

function drawFigures(now) {
  const rows = [];
  now.curves.forEach((own) => {
    const last = own.force.length / 2 - 1, k = own.component;
    if (last >= 0) rows.push([`${state.scene.force.directions[k]} force on ${own.name}`, `${readable(own.force[2 * last + k], 4)} ${state.scene.force.unit}`]);
  });
  now.pressure.forEach((own) => rows.push([`peak pressure, ${own.name}`, `${readable(Math.max(0, ...own.values), 3)} kPa`]));
  const lights = new Set([...state.scene.limits.map((l) => l.measure)]);
  Object.entries(now.measures).forEach(([name, values]) => {
    if (values.length <= MOST_VALUES && !lights.has(name)) rows.push([spoken(name), `${values.map((value, i) => withError(name, value, i)).join(", ")} ${unitOf(name)}`]);
  });
  let peak = 0;
  for (let k = 2; k < now.points.length; k += 3) peak = Math.max(peak, now.points[k]);
  rows.push(["largest stress shown", `${readable(peak, 3)} kPa`]);
  place("figures").replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("li");
    // with its error a value needs smaller letters to stay on one line; several values need more lines
    const kind = value.includes(", ") ? ' class="with-error several"' : value.includes("±") ? ' class="with-error"' : "";
    row.innerHTML = `<span>${escaped(name)}</span><strong${kind}>${escaped(value)}</strong>`;
    return row;
  }));
}

// A value with the error that was estimated at the section of the file, where there is one.
function withError(name, value, at = 0) {
  const error = state.errors && state.errors[name];
  return error ? `${readable(value, 4)} ± ${readable(error[at], 2)}` : readable(value, 4);
}

const bound = (own, i) => (Array.isArray(own) ? own[i] : own);

function drawLights(now) {
  const rows = [];
  const light = (kind, name, text, note) => {
    const row = document.createElement("div");
    row.className = kind;
    row.innerHTML = `<i aria-hidden="true"></i><span>${escaped(name)} <b>${escaped(text)}</b> <small>${escaped(note)}</small></span>`;
    rows.push(row);
  };
  const { minimize, limits } = state.scene;
  if (minimize && now.measures[minimize]) light("aim", `minimise ${spoken(minimize)}`, `${withError(minimize, now.measures[minimize][0])} ${unitOf(minimize)}`, "");
  for (const { measure, lower, upper } of limits) {
    const values = now.measures[measure];
    if (!values) { light("", spoken(measure), "–", "not computed"); continue; }
    let worst = -Infinity, at = 0;
    values.forEach((value, i) => {
      const low = bound(lower, i), high = bound(upper, i), size = Math.max(Math.abs(low ?? 0), Math.abs(high ?? 0), 1e-12);
      const over = Math.max(low === null || low === undefined ? -Infinity : (low - value) / size, high === null || high === undefined ? -Infinity : (value - high) / size);
      if (over > worst) [worst, at] = [over, i];
    });
    const low = bound(lower, at), high = bound(upper, at);
    const range = [low !== null && low !== undefined ? `≥ ${readable(low)}` : "", high !== null && high !== undefined ? `≤ ${readable(high)}` : ""].filter(Boolean).join(", ");
    const note = `${range} ${worst > 1e-6 ? `violated by ${readable(100 * worst, 2)} %` : "satisfied"}`;
    light(worst > 1e-6 ? "broken" : "held", spoken(measure), `${withError(measure, values[at], at)} ${unitOf(measure)}`, note);
  }
  place("lights").replaceChildren(...rows);
}

// ---- one picture ----

let pending = null;

// Draw with the next frame of the screen; `since` is the time of the event that asked for it.
function schedule(since = null) {
  if (pending !== null) { pending = pending.since === null ? { since } : pending; return; }
  pending = { since };
  requestAnimationFrame(() => {
    const { since: from } = pending;
    pending = null;
    draw();
    if (from !== null) {
      state.latencies.push(performance.now() - from);
      if (state.latencies.length > 1000) state.latencies.shift();
    }
  });
}

function draw() {
  if (!state.scene || !state.exact || !state.design) return;
  const now = present();
  document.body.classList.toggle("preview-shown", !now.exactly);
  drawShapes(now);
  drawCharts(now);
  drawFigures(now);
  drawLights(now);
  drawHandles(now);
  showNumbers();
  showState(now.exactly);
  state.drawn += 1;
}

function showState(exactly) {
  const { status, exact } = state, row = place("state");
  let [kind, text] = ["preview", "first-order preview, analysing …"];
  if (!state.rates && !exactly) text = "analysing …";
  if (exactly && exact) [kind, text] = ["exact", "exact analysis"];
  if (exactly && exact && exact.trustworthy === false) [kind, text] = ["failed", "not trustworthy, see the warnings"];
  if (exactly && exact && !exact.converged) [kind, text] = ["failed", "analysis not completed"];
  if (status && status.job === "errors") text = status.progress || "estimating numerical errors";
  if (status && status.job === "improve") text = `optimising, analysis ${exact && exact.number ? exact.number : 0}`;
  if (!exactly && status && status.failure) [kind, text] = ["failed", "not analysed"];
  if (state.closed) [kind, text] = ["failed", "the server is closed"];
  row.className = `state ${kind}`;
  place("state-text").textContent = text;
}

// ---- handles ----

// A handle: numbers it moves with their directions on screen in mm per unit, and where it is.
function handlesOf(now) {
  const { scene, design } = state, index = new Map(scene.numbers.map((own, i) => [own.name, i])), found = [];
  scene.handles.forEach((own) => {
    const at = [...own.at];
    own.numbers.forEach((p, k) => { at[0] += design[p] * own.directions[k][0]; at[1] += design[p] * own.directions[k][1]; });
    found.push({ key: `wall-${own.numbers.join("-")}`, view: "made", at, numbers: own.numbers, directions: own.directions, round: true, text: own.numbers.map((p) => scene.numbers[p].text).join(" and ") });
  });
  scene.profiles.forEach((profile, i) => {
    for (let k = 0; k < now.ways[i].length / 3; k++) {
      const names = k ? [`${profile.name}_stage_${k}_x`, `${profile.name}_stage_${k}_y`] : [`${profile.name}_x`, `${profile.name}_y`];
      const numbers = names.map((name) => index.get(name)), known = numbers.flatMap((p, axis) => (p === undefined ? [] : [[p, axis ? [0, 1] : [1, 0]]]));
      if (!known.length) continue;
      const at = rigid(profile, [...now.ways[i].slice(3 * k, 3 * k + 3)], profile.grip);
      found.push({ key: `${profile.name}-${k}`, view: k ? "pressed" : "made", at, numbers: known.map(([p]) => p), directions: known.map(([, d]) => d), round: false, text: k ? `end of stage ${k} of ${profile.name}` : `start of ${profile.name}` });
    }
  });
  return found;
}

const handleNodes = new Map();

function drawHandles(now) {
  if (state.shared) return;
  const seen = new Set();
  for (const handle of handlesOf(now)) {
    seen.add(handle.key);
    let own = handleNodes.get(handle.key);
    if (!own) {
      const svg = place(`${handle.view}-handles`), group = node(svg, "g");
      const track = node(group, "line", { class: "track" });
      const area = node(group, "circle", { class: "handle-area", r: 17 });
      const mark = handle.round ? node(group, "circle", { class: "handle", r: 6.5 }) : node(group, "rect", { class: "handle", width: 14, height: 14, rx: 3 });
      mark.dataset.handle = handle.key;
      mark.setAttribute("tabindex", "0");
      mark.setAttribute("role", "slider");
      mark.setAttribute("aria-label", handle.text);
      own = { group, track, area, mark };
      handleNodes.set(handle.key, own);
      for (const target of [area, mark]) target.addEventListener("pointerdown", (event) => grab(event, handle.key));
      mark.addEventListener("keydown", (event) => nudge(event, handle.key));
    }
    own.handle = handle;
    const view = views[handle.view], x = view.px(handle.at[0]), y = view.py(handle.at[1]);
    own.area.setAttribute("cx", x);
    own.area.setAttribute("cy", y);
    if (handle.round) { own.mark.setAttribute("cx", x); own.mark.setAttribute("cy", y); } else { own.mark.setAttribute("x", x - 7); own.mark.setAttribute("y", y - 7); }
    const [first] = handle.numbers, number = state.scene.numbers[first], value = state.design[first];
    own.mark.classList.toggle("bounded", handle.numbers.some((p) => state.design[p] === state.scene.numbers[p].low || state.design[p] === state.scene.numbers[p].high));
    for (const [key, v] of [["min", number.low], ["max", number.high], ["now", value]]) own.mark.setAttribute(`aria-value${key}`, v.toFixed(3));
    own.mark.setAttribute("aria-valuetext", handle.numbers.map((p) => `${readable(state.design[p], 4)} ${state.scene.numbers[p].unit}`).join(", "));
    // where the handle may go, of one number
    if (handle.numbers.length === 1) {
      const [dx, dy] = handle.directions[0], ends = [number.low, number.high].map((v) => [handle.at[0] + (v - value) * dx, handle.at[1] + (v - value) * dy]);
      own.track.setAttribute("x1", view.px(ends[0][0])); own.track.setAttribute("y1", view.py(ends[0][1]));
      own.track.setAttribute("x2", view.px(ends[1][0])); own.track.setAttribute("y2", view.py(ends[1][1]));
    }
  }
  for (const [key, own] of handleNodes) if (!seen.has(key)) { own.group.remove(); handleNodes.delete(key); }
}

// The design with the numbers of a handle changed so that it moves by (dx, dy) mm from `from`.
function pulled(handle, from, dx, dy) {
  const design = [...from];
  handle.numbers.forEach((p, k) => {
    const [a, b] = handle.directions[k], size = a * a + b * b;
    design[p] = clipped(p, from[p] + (dx * a + dy * b) / size);
  });
  return design;
}

function clipped(p, value) {
  const { low, high } = state.scene.numbers[p];
  return Math.min(high, Math.max(low, Number(value.toPrecision(12))));
}

function grab(event, key) {
  const own = handleNodes.get(key);
  if (event.button > 0) return;
  event.preventDefault();
  own.mark.focus();
  const view = views[own.handle.view], from = state.design, begin = [event.clientX, event.clientY], { handle } = own;
  event.target.setPointerCapture(event.pointerId);
  own.mark.classList.add("dragged");
  state.dragging = true;
  const move = (moving) => {
    change(pulled(handle, from, (moving.clientX - begin[0]) / view.zoom, -(moving.clientY - begin[1]) / view.zoom), "drag", moving.timeStamp);
  };
  const end = () => {
    event.target.removeEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) event.target.removeEventListener(name, end);
    own.mark.classList.remove("dragged");
    state.dragging = false;
    change(state.design, "commit");
  };
  event.target.addEventListener("pointermove", move);
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) event.target.addEventListener(name, end);
}

function nudge(event, key) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (!arrows[event.key]) return;
  event.preventDefault();
  const { handle } = handleNodes.get(key), [dx, dy] = arrows[event.key], step = KEY_STEP * (event.shiftKey ? 5 : 1);
  const design = [...state.design];
  handle.numbers.forEach((p, k) => {
    const [a, b] = handle.directions[k], along = dx * a + dy * b;
    // across the direction of a handle, up and right are outward of what it has
    const sign = Math.abs(along) > 1e-3 * Math.hypot(a, b) ? Math.sign(along) : handle.numbers.length > 1 ? 0 : dx + dy;
    design[p] = clipped(p, design[p] + (sign * step) / Math.hypot(a, b));
  });
  change(design, "commit", event.timeStamp);
}

// ---- sliders ----

const rows = [];

function makeSliders() {
  const { scene } = state, groups = {};
  rows.length = 0;
  scene.numbers.forEach((own, p) => { (groups[own.group] ||= []).push(p); });
  const parts = [], order = ["travel", "friction", "rubber", "environment", "time", "start", "section"];
  const titles = { travel: "Travel", friction: "Friction", rubber: "Rubber", environment: "Environment", time: "Time", start: "Start of the profiles", section: "Design parameters of the section" };
  for (const name of order.filter((n) => groups[n])) {
    const title = document.createElement("h2");
    title.textContent = titles[name];
    parts.push(title);
    for (const p of groups[name]) {
      const own = scene.numbers[p], row = document.createElement("label");
      row.className = "slider";
      row.innerHTML = `<span>${escaped(own.text)}${own.unit ? ` (${escaped(own.unit)})` : ""}</span>`;
      const exactly = document.createElement("input"), range = document.createElement("input"), note = document.createElement("small");
      note.setAttribute("role", "status");
      Object.assign(exactly, { type: "number", step: "any" });
      Object.assign(range, { type: "range", min: own.low, max: own.high, step: "any", id: `number-${p}` });
      for (const input of [exactly, range]) input.setAttribute("aria-label", own.text);
      const set = (value, kind, since) => {
        if (!Number.isFinite(value)) return;
        const design = [...state.design];
        design[p] = clipped(p, value);
        change(design, kind, since);
      };
      // a typed number outside the range is replaced by the end of the range, which the page says
      const type = () => {
        const text = exactly.value, value = exactly.valueAsNumber;
        set(value, "commit");
        rows[p].noted = state.design[p];
        exactly.value = typed(state.design[p]);
        note.textContent = value < own.low || value > own.high ? `${text} is outside the range of this page, ${typed(own.low)} to ${typed(own.high)}${own.unit ? ` ${own.unit}` : ""}; ${exactly.value} is used` : "";
      };
      range.addEventListener("input", (event) => set(Number(range.value), "drag", event.timeStamp));
      range.addEventListener("change", () => set(Number(range.value), "commit"));
      range.addEventListener("keydown", (event) => {
        const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        if (!sign) return;
        event.preventDefault();
        set(state.design[p] + sign * (event.shiftKey ? 0.05 : 0.01) * (own.high - own.low), "commit", event.timeStamp);
      });
      exactly.addEventListener("change", type);
      row.append(exactly, range, note);
      rows[p] = { row, range, exactly, note };
      parts.push(row);
    }
  }
  place("sliders").replaceChildren(...parts);
}

// A number as it fits into its field.
function typed(value) {
  const rounded = Number(value.toPrecision(5)), text = String(rounded);
  return text.length > 8 ? rounded.toExponential() : text;
}

function showNumbers() {
  rows.forEach(({ row, range, exactly, note, noted }, p) => {
    const value = state.design[p];
    if (value !== noted) note.textContent = "";
    if (Number(range.value) !== value) range.value = value;
    if (document.activeElement !== exactly) exactly.value = typed(value);
    row.classList.toggle("changed", value !== state.scene.numbers[p].value);
  });
}

// ---- messages ----

function send(message) {
  if (state.socket && state.socket.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify(message));
}

let queued = null;

// Show a design at once, and tell the server: of a drag the latest with every frame of the screen.
function change(design, kind, since = null) {
  if (!state.scene) return;
  state.design = design;
  schedule(since);
  state.change += 1;
  if (kind === "commit") { queued = null; send({ do: "commit", design, change: state.change }); return; }
  if (queued === null) requestAnimationFrame(() => { if (queued) send({ do: "drag", design: queued, change: state.change }); queued = null; });
  queued = design;
}

const receive = {
  status(status) {
    state.status = status;
    // another file is being opened: nothing of the last one is valid
    if (!status.ready) Object.assign(state, { scene: null, exact: null, rates: null, design: null });
    place("undo").disabled = !status.undo;
    place("redo").disabled = !status.redo;
    place("stop").hidden = status.job !== "improve";
    place("improve").hidden = status.job === "improve";
    const files = place("files"), names = status.files.map((name) => new Option(name, name, false, name === status.file));
    if (!status.file) names.unshift(new Option("choose", "", true, true));
    files.replaceChildren(...names);
    place("title").textContent = status.file || "seal-mdao studio";
    place("empty").hidden = Boolean(status.file);
    place("work").hidden = !status.ready;
    if (status.failure) show(status.failure);
    if (!status.ready && status.file) { place("state").className = "state"; place("state-text").textContent = status.failure ? "not opened" : status.progress || "opening"; }
    if (state.exact && state.design) showState(isExact());
  },
  progress({ text }) {
    if (state.status) state.status.progress = text;
    if (state.exact && state.design) showState(isExact());
    if (!state.scene) place("state-text").textContent = text;
  },
  scene(scene) {
    Object.assign(state, { scene, exact: null, rates: null, scatter: null, design: null, errors: null });
    scene.undeformedAt = floats(scene.undeformed);
    scene.velocityAt = floats(scene.velocity);
    for (const [, own] of handleNodes) own.group.remove();
    handleNodes.clear();
    for (const id of ["curve", "pressure"]) { place(id).replaceChildren(); delete charts[id]; }
    place("work").hidden = false;
    place("empty").hidden = true;
    for (const name of ["made", "pressed"]) {
      if (!views[name]) views[name] = new ShapeView(place(name), shapesOf(scene));
      views[name].shapes = shapesOf(scene);
      views[name].last = null;
      views[name].subdivide = name === "pressed" ? 2 : 1;
    }
    place("problem-panel").hidden = true;
    place("message").dataset.kind = "";
    place("message").hidden = true;
    place("step").max = scene.steps - 1;
    place("step").value = scene.steps - 1;
    makeSliders();
  },
  design({ design, change: followed }) {
    // one that does not follow the last change of this page is older than what is shown
    if (state.dragging || !state.scene || followed < state.change) return;
    state.design = design;
    schedule();
  },
  exact(exact) {
    if (!state.scene) return;
    state.counts.exact = (state.counts.exact || 0) + 1;
    Object.assign(state, { exact, rates: null });
    unpackFrame(exact.frame);
    hide();
    // how an optimisation ended comes with its last state
    if (exact.message && !state.shared) show(`Optimisation ${exact.success ? "converged" : "not converged"}: ${exact.message}`, exact.success ? "ended" : "");
    if (!exact.converged) show(`The analysis of this design was not completed: ${exact.failure}`);
    showWarnings(exact.warnings);
    showPath();
    if (!state.design) state.design = exact.design;
    schedule();
  },
  rates(rates) {
    if (!state.exact || rates.step !== state.exact.frame.step) return;
    unpackRates(rates);
    state.rates = rates;
    state.scatter = rates.scatter;
    schedule();
  },
  checks(checks) {
    if (!state.exact) return;
    Object.assign(state.exact, checks);
    showWarnings(checks.warnings);
    schedule();
  },
  view(frame) {
    if (!state.exact) return;
    unpackFrame(frame);
    state.exact.frame = frame;
    state.rates = null;
    showPath();
    schedule();
  },
  kept(kept) {
    state.kept = kept;
    showKept();
    schedule();
  },
  errors(errors) {
    state.errors = errors;
    place("made-text").textContent = "±: estimated numerical error, for the section in the seal file";
    schedule();
  },
  notes(notes) { place("caption").textContent = notes.join(" "); },
  saved(names) { show(`Saved: ${names.join(", ")}`, "saved", names); },
  failed({ text }) { show(text); },
  refused(text) { show(text); },
};

function unpackFrame(frame) {
  frame.pointsAt = floats(frame.points);
  frame.touchingAt = floats(frame.touching);
}

function showPath() {
  const { exact } = state;
  if (Number(place("step").value) !== exact.frame.step && document.activeElement !== place("step")) place("step").value = exact.frame.step;
  place("step-text").textContent = exact.frame.caption;
  place("pressed-text").textContent = exact.frame.caption;
}

function show(text, kind = "", names = []) {
  const box = place("message");
  box.hidden = false;
  box.textContent = text;
  box.dataset.kind = kind;
  for (const name of names) {
    const link = document.createElement("a");
    Object.assign(link, { href: `files/${encodeURIComponent(name)}`, textContent: `Download ${name}`, download: name });
    box.append(" ", link);
  }
}

// Hide what is about the last analysis or optimisation.
function hide() { if (["", "ended"].includes(place("message").dataset.kind || "")) place("message").hidden = true; }

function showWarnings(texts) {
  const box = place("warnings");
  box.hidden = !texts.length;
  box.replaceChildren(...texts.map((text) => Object.assign(document.createElement("p"), { className: "note", textContent: text })));
}

function showKept() {
  const { kept, scene } = state, box = place("compared");
  box.hidden = !kept.length;
  if (!kept.length || !scene) return;
  // a design whose path was not completed has no measures
  const names = [...new Set(kept.flatMap((own) => Object.keys(own.measures)))], head = kept.map(({ name }, i) => `<th scope="col"><i style="background:${color(i + 2)}"></i> ${escaped(name)}</th>`).join("");
  const cells = (of) => kept.map((own) => `<td>${escaped(of(own))}</td>`).join("");
  const lines = names.map((name) => `<tr><th scope="row">${escaped(spoken(name))} ${escaped(unitOf(name))}</th>${cells((own) => (own.measures[name] || []).map((v) => readable(v, 4)).join(", ") || "–")}</tr>`);
  const changed = scene.numbers.map((own, p) => [own, p]).filter(([own, p]) => kept.some((k) => k.design[p] !== own.value));
  const numbers = changed.map(([own, p]) => `<tr><th scope="row">${escaped(own.text)} ${escaped(own.unit)}</th>${cells((k) => readable(k.design[p], 4))}</tr>`);
  const buttons = kept.map(({ name }) => `<td data-live><button data-take="${escaped(name)}">Use</button> <button data-drop="${escaped(name)}">Remove</button></td>`).join("");
  box.innerHTML = `<h2>Compared designs</h2><div class="scroll"><table><thead><tr><th scope="col">measure</th>${head}</tr></thead><tbody>${lines.join("")}${numbers.join("")}<tr><th scope="row"></th>${buttons}</tr></tbody></table></div>`;
  box.querySelectorAll("[data-take]").forEach((button) => button.addEventListener("click", () => send({ do: "take", name: button.dataset.take })));
  box.querySelectorAll("[data-drop]").forEach((button) => button.addEventListener("click", () => send({ do: "drop", name: button.dataset.drop })));
}

// ---- the problem ----

function showProblem() {
  const { scene } = state, { offered } = scene, box = place("problem-panel"), names = Object.keys(offered.edges);
  const [low, high] = [scene.low, scene.high], flip = (y) => low[1] + high[1] - y;
  const lines = names.map((name, i) => offered.edges[name].map((line) => `<path style="stroke:${color(i)}" d="M${line.map(([x, y]) => `${x} ${flip(y)}`).join("L")}"><title>${escaped(name)}</title></path>`).join("")).join("");
  const box_ = (group, name) => `<td><input type="checkbox" data-group="${group}" value="${escaped(name)}" aria-label="${escaped(name)} ${group}" ${offered[group].includes(name) ? "checked" : ""}></td>`;
  const rows = names.map((name, i) => `<tr><th scope="row"><i class="swatch" style="background:${color(i)}"></i>${escaped(name)}</th>${["fixed", "pressed", "moving"].map((group) => box_(group, name)).join("")}</tr>`).join("");
  const options = (chosen, none) => `${none ? `<option value="">${none}</option>` : ""}${offered.measures.map((name) => `<option value="${escaped(name)}" ${name === chosen ? "selected" : ""}>${escaped(spoken(name))}</option>`).join("")}`;
  const limit = ({ measure, lower, upper }) => `<div class="row limit"><select aria-label="measure">${options(measure)}</select> at least <input type="number" step="any" class="lower" aria-label="at least" value="${lower ?? ""}"> at most <input type="number" step="any" class="upper" aria-label="at most" value="${upper ?? ""}"> <button type="button" class="remove">Remove</button></div>`;
  box.innerHTML = `<h2>Problem</h2><div class="parts"><svg class="edges" viewBox="${low[0]} ${low[1]} ${high[0] - low[0]} ${high[1] - low[1]}" role="img" aria-label="Edges of the section">${lines}</svg>
    <form><table><thead><tr><th scope="col">edge</th><th scope="col">fixed</th><th scope="col">touches the profile</th><th scope="col">may move</th></tr></thead><tbody>${rows}</tbody></table>
    <div class="row">Every edge that may move has <input type="number" id="parameters" min="1" max="40" value="${offered.parameters}" aria-label="parameters of an edge"> design parameters and moves by at most <input type="number" id="bound" step="any" min="0" value="${offered.bound}" aria-label="largest offset, mm"> mm.</div>
    <div class="row">Minimise <select id="aim" aria-label="minimise">${options(offered.minimize, "nothing")}</select></div>
    <div id="limits">${offered.limits.map(limit).join("")}</div>
    ${offered.unseen.length ? `<p class="note">The limits of ${escaped(offered.unseen.map(spoken).join(", "))} at several values stay as they are in the seal file.</p>` : ""}
    <div class="row"><button type="button" id="add-limit">Add a limit</button> <button type="submit">Write the seal file and open it</button></div></form></div>`;
  box.querySelector("#limits").addEventListener("click", (event) => { if (event.target.className === "remove") event.target.parentElement.remove(); });
  box.querySelector("#add-limit").addEventListener("click", () => box.querySelector("#limits").insertAdjacentHTML("beforeend", limit({ measure: "reaction" })));
  box.querySelector("form").addEventListener("submit", (event) => {
    event.preventDefault();
    const chosen = (group) => [...box.querySelectorAll(`[data-group="${group}"]:checked`)].map((input) => input.value);
    const number = (input) => (input.value === "" ? null : Number(input.value));
    const limits = [...box.querySelectorAll(".limit")].map((row) => ({ measure: row.querySelector("select").value, lower: number(row.querySelector(".lower")), upper: number(row.querySelector(".upper")) }));
    show("Writing the seal file …", "wait");
    send({ do: "problem", fixed: chosen("fixed"), pressed: chosen("pressed"), moving: chosen("moving"), parameters: number(box.querySelector("#parameters")), bound: number(box.querySelector("#bound")), minimize: box.querySelector("#aim").value, limits });
  });
}

// ---- drawings ----

async function drop(file) {
  show(`Reading ${file.name} …`, "wait");
  const answer = await fetch(`drawing?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
  show(await answer.text(), answer.ok ? "wait" : "");
}

for (const kind of ["dragenter", "dragover"]) document.addEventListener(kind, (event) => { event.preventDefault(); document.body.classList.add("dropping"); });
document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
document.addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  if (!state.shared && event.dataTransfer.files.length) drop(event.dataTransfer.files[0]);
});

function connect() {
  const socket = new WebSocket(new URL("live", location.href.replace(/^http/, "ws")));
  state.socket = socket;
  socket.addEventListener("message", (event) => {
    const { kind, content } = JSON.parse(event.data);
    receive[kind](content);
  });
  socket.addEventListener("open", () => { state.closed = false; state.change = 0; });
  socket.addEventListener("close", (event) => {
    state.closed = true;
    showState(false);
    if (event.reason) show(event.reason);
    else setTimeout(connect, 2000);
  });
}

place("problem").addEventListener("click", () => {
  const box = place("problem-panel");
  if (!state.scene) return;
  box.hidden = !box.hidden;
  place("problem").setAttribute("aria-expanded", String(!box.hidden));
  if (!box.hidden) { showProblem(); box.scrollIntoView({ block: "nearest" }); }
});
place("drawing").addEventListener("change", (event) => { if (event.target.files.length) drop(event.target.files[0]); });
for (const name of ["undo", "redo", "improve", "stop", "keep", "save", "share", "errors"]) place(name).addEventListener("click", () => send({ do: name }));
place("files").addEventListener("change", (event) => { if (event.target.value) send({ do: "open", file: event.target.value }); });
place("step").addEventListener("input", (event) => send({ do: "view", step: Number(event.target.value) }));
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey)) return;
  const key = event.key.toLowerCase();
  if (key === "z" || key === "y") {
    event.preventDefault();
    send({ do: key === "y" || event.shiftKey ? "redo" : "undo" });
  }
});
new ResizeObserver(() => schedule()).observe(place("work"));
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => schedule());

if (place("shared")) {
  // a page to give away: one state, which nothing changes
  const shared = JSON.parse(place("shared").textContent);
  state.shared = true;
  document.querySelectorAll("[data-live]").forEach((part) => { part.hidden = true; });
  place("title").textContent = shared.file;
  place("made-text").textContent = "";
  receive.scene(shared.scene);
  receive.kept(shared.kept);
  receive.exact(shared.exact);
  if (shared.errors) receive.errors(shared.errors);
  showKept();
  document.querySelectorAll("[data-live]").forEach((part) => { part.hidden = true; });
} else connect();
