// Puts the data into the page and lets the two sliders move it.

const data = JSON.parse(document.getElementById("report-data").textContent);
const { history } = data;
// the address says which of several seals is shown
const chosen = Math.max(0, data.seals.indexOf(decodeURIComponent(location.hash.slice(1))));
const shapes = chosen ? data.others[chosen - 1] : data.shapes;
document.querySelectorAll("nav.choice a").forEach((link, i) => { if (i === chosen) link.setAttribute("aria-current", "true"); });
window.addEventListener("hashchange", () => location.reload());
const place = (id) => document.getElementById(id);
const color = (i) => `var(--c${i % 8})`;
const unitText = (unit) => (unit ? ` (${unit})` : "");

// A slider with its play button; show(index) is called whenever it moves.
function slider(name, count, first, show, pause) {
  const input = place(name), button = place(`${name}-play`);
  let timer = null;
  input.max = count - 1;
  input.value = first;
  const stop = () => {
    clearInterval(timer);
    timer = null;
    button.textContent = "Play";
    button.setAttribute("aria-pressed", "false");
  };
  const move = (index) => {
    input.value = index;
    show(Number(input.value));
  };
  input.addEventListener("input", () => { stop(); show(Number(input.value)); });
  button.addEventListener("click", () => {
    if (timer !== null) { stop(); return; }
    if (Number(input.value) >= count - 1) move(0);
    button.textContent = "Pause";
    button.setAttribute("aria-pressed", "true");
    timer = setInterval(() => {
      move(Number(input.value) + 1);
      if (Number(input.value) >= count - 1) stop();
    }, pause);
  });
  show(first);
  return move;
}

// ---- both designs under the closing door ----

function closing() {
  const { paths, around, across } = shapes, size = 3 * around * across;
  const views = ["start-shape", "end-shape"].map((id) => new ShapeView(place(id), shapes));
  const frames = paths.map((path) => unpack(path.frames));
  const [start, end] = paths, names = ["start", "end"], colors = ["var(--start)", "var(--end)"], dashes = ["6 3", ""];
  const touched = (path) => path.arc.filter((_, k) => path.state.some((s) => s[k] !== "0"));
  const arcs = paths.flatMap(touched), margin = 1.5;
  const along = { label: "arc length (mm)", low: Math.min(...arcs) - margin, high: Math.max(...arcs) + margin };
  const highest = Math.max(...paths.flatMap((path) => path.pressure.flat()));
  const open = paths.flatMap((path) => path.gap.flatMap((gaps, i) => { const o = opened(path.state[i]); return gaps.filter((_, k) => o[k]); }));
  const widest = Math.max(0.02, ...open);
  const series = (key) => paths.map((path, i) => ({ name: names[i], x: path.arc, values: path[key][0], color: colors[i], dash: dashes[i], dots: 2.4 }));
  const pressure = new LineChart(place("pressure"), { name: "True contact pressure", x: along, y: { label: "kPa", low: 0, high: 1.08 * highest || 1 }, series: series("pressure") });
  const gap = new LineChart(place("gap"), { name: "Normal gap", x: along, y: { label: "mm", low: -0.12 * widest, high: 1.15 * widest }, series: series("gap") });
  const forces = [];
  for (const [component, word, dash] of [[1, "vertical", ""], [0, "horizontal", "2 3"]]) {
    paths.forEach((path, i) => forces.push({ name: `${word}, ${names[i]}`, x: path === start ? undefined : path.travel, values: path.reaction.map((r) => r[component]), color: colors[i], dash: dash || dashes[i] }));
  }
  const longest = start.travel.length >= end.travel.length ? start : end;
  if (longest === end) forces.forEach((s, k) => { s.x = k % 2 ? undefined : start.travel; });
  const reaction = new LineChart(place("reaction"), { name: "Force on the door", x: { label: "door travel (mm)", values: longest.travel }, y: { label: "N/m" }, series: forces });
  units([["pressure", "kPa"], ["gap", "mm"], ["reaction", "N/m"]]);
  stressScale();
  const show = (index) => {
    paths.forEach((path, i) => {
      const k = Math.min(index, path.travel.length - 1), held = k < index ? " (path ends here)" : "";
      const frame = { points: frames[i].subarray(size * k, size * (k + 1)), door: path.door, position: path.position[k], state: path.state[k] };
      const touching = [...path.state[k]].filter((s) => s !== "0").length;
      const text = `peak ${readable(path.peak[k], 3)} kPa, ${touching} points in contact, ${readable(path.reaction[k][1], 3)} N/m${held}`;
      views[i].draw(frame, null, `Deformed section of the ${names[i]} design with von Mises stress at door travel ${readable(path.travel[k], 3)} mm: ${text}`);
      place(`${names[i]}-text`).textContent = text;
    });
    const at = (path, key) => path[key][Math.min(index, path.travel.length - 1)];
    pressure.set(paths.map((path) => at(path, "pressure")));
    gap.set(paths.map((path) => at(path, "gap")));
    reaction.cursor(index);
    place("step-value").textContent = `${readable(longest.travel[index], 3)} mm after first touch of the drawn seal`;
  };
  slider("step", longest.travel.length, longest.travel.length - 1, show, 60);
  return views;
}

function units(pairs) {
  for (const [id, unit] of pairs) {
    const span = document.createElement("span");
    span.textContent = unit;
    place(id).parentElement.querySelector("figcaption").append(span);
  }
}

function stressScale() {
  const bar = document.createElement("i"), host = place("stress-scale");
  bar.style.background = `linear-gradient(to right, ${shapes.colours.join(",")})`;
  host.append("0", bar, `${readable(shapes.top)} kPa von Mises stress`);
}

// ---- through the iterations ----

function histories() {
  const count = history.objective.values.length, numbers = Array.from({ length: count }, (_, i) => i);
  const kind = history.major ? "iteration" : "evaluation", x = { label: kind, values: numbers, integer: true };
  place("iteration-label").textContent = kind[0].toUpperCase() + kind.slice(1);
  const { objective, constraints, design, violation } = history, charts = [];
  const positive = objective.values.every((v) => v >= 0) && objective.values.some((v) => v > 0);
  const spread = positive && Math.max(...objective.values) > 20 * Math.min(...objective.values);
  charts.push(new LineChart(place("objective"), {
    name: `Objective: ${objective.label}`, x, y: { label: objective.label, log: spread },
    series: [{ name: objective.label, values: objective.values, color: color(0), dots: 4, hollow: violation.map((v) => v > 1e-3) }],
  }));
  caption("objective", `${objective.label}${unitText(objective.unit)}`);
  if (constraints.length) {
    charts.push(new LineChart(place("constraints"), {
      name: "Constraints over their limits", x, y: { label: "value / limit" }, over: 1, limits: [{ at: 1, text: "limit" }],
      series: constraints.map((c, i) => ({
        name: c.label, values: c.use, color: color(i), dash: ["", "7 3", "2 3"][Math.floor(i / 8) % 3], dots: count < 40 ? 2.4 : 0,
        tip: (k) => `${readable(c.values[k])}${c.unit ? ` ${c.unit}` : ""} (${readable(100 * c.use[k], 3)} %)`,
      })),
      legend: constraints.length <= 24,
    }));
    caption("constraints", "below 1: satisfied");
  } else {
    place("constraints").parentElement.hidden = true;
  }
  for (const part of design) charts.push(designChart(part, x));
  return { charts, count, kind };
}

function designChart(part, x) {
  const figure = document.createElement("figure"), text = document.createElement("figcaption"), host = document.createElement("div");
  text.textContent = part.label;
  host.className = "chart";
  host.id = `design-${part.label.replace(/\W+/g, "-")}`;
  figure.append(text, host);
  place("design").append(figure);
  const several = part.values.length;
  const limits = [part.lower, part.upper].filter((v) => v !== null).map((at) => ({ at }));
  const chart = new LineChart(host, {
    name: part.label, x, y: { label: part.unit }, limits, legend: several <= 6,
    series: part.values.map((values, i) => ({
      name: several > 1 ? `no. ${i + 1}` : part.label, values, dots: several === 1 ? 3 : 0,
      color: several > 8 ? `hsl(${Math.round(210 + (i / (several - 1)) * 180) % 360} 55% 48%)` : color(i),
    })),
  });
  caption(host.id, part.unit);
  return chart;
}

function caption(id, text) {
  const span = document.createElement("span");
  span.textContent = text;
  place(id).parentElement.querySelector("figcaption").append(span);
}

function designs() {
  const frames = shapes.designs.map((d) => ({ ...d, points: unpack(d.frame) }));
  const drawn = shapes.designs.map((d) => ({ points: unpack(d.drawn), across: 2, width: 2, stressed: false, door: d.door }));
  const views = [new ShapeView(place("design-drawn"), shapes), new ShapeView(place("design-shape"), shapes)];
  const lifted = shapes.paths[0].position[0];
  const show = (index, text) => {
    let k = 0;
    shapes.numbers.forEach((number, i) => { if (number <= index) k = i; });
    const aside = shapes.numbers[k] === index ? "" : ` (shape of ${shapes.numbers[k]})`;
    views[0].draw({ ...drawn[k], position: lifted, doorGhost: drawn[0].door }, drawn[0], `Undeformed section at ${text}${aside}, start dashed`);
    views[1].draw(frames[k], frames[0], `Deformed section under the closed door at ${text}${aside}: peak stress ${readable(frames[k].peak, 3)} kPa`);
    place("design-text").textContent = `peak ${readable(frames[k].peak, 3)} kPa; dashed: start${aside}`;
  };
  return { views, show };
}

function iterations() {
  const { charts, count, kind } = histories(), pictures = shapes && designs();
  const { objective, violation } = history;
  const show = (index) => {
    charts.forEach((chart) => chart.cursor(index));
    const value = `${readable(objective.values[index])}${objective.unit ? ` ${objective.unit}` : ""}`;
    place("iteration-value").textContent = `${index} of ${count - 1}: ${value}, violation ${readable(100 * violation[index], 3)} %`;
    if (pictures) pictures.show(index, `${kind} ${index}`);
  };
  slider("iteration", count, count - 1, show, 550);
  return pictures ? pictures.views : [];
}

const views = [...(shapes ? closing() : []), ...iterations()];
const redraw = () => views.forEach((view) => view.redraw());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
matchMedia("print").addEventListener("change", redraw);
window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
document.documentElement.dataset.ready = "true";
