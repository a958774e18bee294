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

// ---- both designs along the path ----

// The numbers of a picture, unpacked.
const frame = ({ points, touching, marks, poses, peak }, profiles) => ({ points: unpack(points), touching: unpack(touching), marks, poses, peak, profiles });

// A force with its unit, of a ring per length of circumference too.
function force(value) {
  const { unit, per_mm: factor } = shapes.force;
  return `${readable(value, 3)} ${unit}${factor ? ` (${readable(factor * value, 3)} N/mm)` : ""}`;
}

function closing() {
  const { paths } = shapes, places = ["start", "end"], names = data.ends, [start, end] = paths;
  const views = places.map((name) => new ShapeView(place(`${name}-shape`), shapes));
  const frames = paths.map((path) => path.frames.map((own) => frame(own, path.profiles)));
  const longest = start.frames.length >= end.frames.length ? start : end;
  let curves = null, at = longest.frames.length - 1, profile = 0;
  stressScale();
  units([["pressure", "kPa"], ["gap", "mm"], ["reaction", shapes.force.unit]]);
  const show = (index) => {
    at = index;
    paths.forEach((path, i) => {
      const k = Math.min(index, path.frames.length - 1), held = k < index ? " (analysis ends here)" : "", own = path.curves[profile];
      const touching = own && own.arc.length ? `, ${[...own.state[k]].filter((s) => "12".includes(s)).length} points in contact` : "";
      const main = own ? start.curves[profile].component : 0;
      const up = own ? `, ${shapes.force.directions[main]} force ${force(own.reaction[k][main])}` : "";
      const text = `peak ${readable(path.frames[k].peak, 3)} kPa${touching}${up}${held}`;
      views[i].draw(frames[i][k], null, `Deformed section, ${names[i]}, with von Mises stress at ${minus(path.captions[k])}: ${text}`);
      place(`${places[i]}-text`).textContent = text;
    });
    if (curves) curves.show(index);
    place("step-value").textContent = minus(longest.captions[index]);
  };
  const choose = (chosen) => {
    profile = chosen;
    curves = profileCurves(paths.map((path) => path.curves[chosen]), paths.indexOf(longest));
    show(at);
  };
  if (start.curves.length) {
    profileChoice(start.curves.map((own) => own.name), choose);
    choose(0);
  } else {
    place("curves").hidden = true;
    place("profile-label").hidden = true;
  }
  slider("step", longest.frames.length, at, show, 60);
  return views;
}

// Charts of one profile of both designs, or of moved edges; show(index) takes them to a load step.
function profileCurves(both, longest) {
  const names = data.ends, colors = ["var(--start)", "var(--end)"], dashes = ["6 3", ""];
  ["pressure", "gap", "reaction"].forEach((id) => place(id).replaceChildren());
  // moved edges are in no contact
  const touches = both.every((own) => own.arc.length);
  ["pressure", "gap"].forEach((id) => { place(id).parentElement.hidden = !touches; });
  const contact = touches ? contactCurves(both, names, colors, dashes) : null;
  const forces = [];
  const main = both[0].component;
  for (const [component, dash] of [[main, ""], [1 - main, "2 3"]]) {
    const word = shapes.force.directions[component];
    both.forEach((own, i) => forces.push({ name: `${word}, ${names[i]}`, x: i === longest ? undefined : own.along, values: own.reaction.map((r) => r[component]), color: colors[i], dash: dash || dashes[i] }));
  }
  const { name, words, along: values } = both[longest];
  const reaction = new LineChart(place("reaction"), { name: `Force on ${name}`, x: { label: words, values }, y: { label: shapes.force.unit }, series: forces });
  return {
    show(index) {
      if (contact) contact(index);
      reaction.cursor(index);
    },
  };
}

// Charts along the contact points of both designs; what is returned takes them to a load step.
function contactCurves(both, names, colors, dashes) {
  const touched = (own) => own.arc.filter((_, k) => own.state.some((s) => s[k] !== "0"));
  const found = both.flatMap(touched), arcs = found.length ? found : both.flatMap((own) => own.arc);
  const size = Math.max(...both.flatMap((own) => own.arc)), margin = 0.03 * size;
  const along = { label: "arc length (mm)", low: Math.min(...arcs) - margin, high: Math.max(...arcs) + margin };
  const highest = Math.max(...both.flatMap((own) => own.pressure.flat()));
  const open = both.flatMap((own) => own.gap.flatMap((gaps, i) => gaps.filter((_, k) => own.state[i][k] === "3")));
  const widest = Math.max(0.02, ...open);
  const series = (key) => both.map((own, i) => ({ name: names[i], x: own.arc, values: own[key][0], color: colors[i], dash: dashes[i], dots: 2.4 }));
  const pressure = new LineChart(place("pressure"), { name: "True contact pressure", x: along, y: { label: "kPa", low: 0, high: 1.08 * highest || 1 }, series: series("pressure") });
  const gap = new LineChart(place("gap"), { name: "Normal gap", x: along, y: { label: "mm", low: -0.12 * widest, high: 1.15 * widest }, series: series("gap") });
  return (index) => {
    const at = (own, key) => own[key][Math.min(index, own.along.length - 1)];
    pressure.set(both.map((own) => at(own, "pressure")));
    gap.set(both.map((own) => at(own, "gap")));
  };
}

// Which of several profiles the charts are of.
function profileChoice(names, choose) {
  const choice = place("profile");
  names.forEach((name, i) => choice.append(new Option(name, i)));
  place("profile-label").hidden = names.length < 2;
  choice.addEventListener("change", () => choose(Number(choice.value)));
}

function units(pairs) {
  for (const [id, unit] of pairs) {
    const span = document.createElement("span");
    span.textContent = unit;
    place(id).parentElement.querySelector("figcaption").append(span);
  }
}

function stressScale() {
  for (const { name, top, colours } of shapes.scales) {
    const bar = document.createElement("i"), row = document.createElement("div");
    row.className = "scale";
    bar.style.background = `linear-gradient(to right, ${colours.join(",")})`;
    row.append(name ? `${name}: 0` : "0", bar, `${readable(top)} kPa von Mises stress`);
    place("stress-scale").append(row);
  }
}

// ---- through the iterations ----

function histories() {
  const count = history.violation.length, numbers = Array.from({ length: count }, (_, i) => i);
  const kind = history.major ? "iteration" : "evaluation", x = { label: kind, values: numbers, integer: true, starts: history.run_starts };
  place("iteration-label").textContent = kind[0].toUpperCase() + kind.slice(1);
  const { objective, constraints, design, violation } = history, charts = [];
  if (objective) {
    const positive = objective.values.every((v) => v >= 0) && objective.values.some((v) => v > 0);
    const spread = positive && Math.max(...objective.values) > 20 * Math.min(...objective.values);
    charts.push(new LineChart(place("objective"), {
      name: `Objective: ${objective.label}`, x, y: { label: objective.label, log: spread },
      series: [{ name: objective.label, values: objective.values, color: color(0), dots: 4, hollow: violation.map((v) => v > 1e-3) }],
    }));
    caption("objective", `${objective.label}${unitText(objective.unit)}`);
  } else {
    place("objective").parentElement.hidden = true;
  }
  if (constraints.length) {
    charts.push(new LineChart(place("constraints"), {
      name: "Constraints divided by their limits", x, y: { label: "value / limit" }, over: 1, limits: [{ at: 1, text: "limit" }],
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
  const frames = shapes.designs.map((d) => frame(d.frame, d.profiles));
  const drawn = shapes.designs.map((d) => ({ boundary: unpack(d.boundary), profiles: d.profiles, poses: d.begin, ghosts: shapes.designs[0].profiles }));
  const views = [new ShapeView(place("design-drawn"), shapes), new ShapeView(place("design-shape"), shapes)];
  const show = (index, text) => {
    let k = 0;
    shapes.numbers.forEach((number, i) => { if (number <= index) k = i; });
    const aside = shapes.numbers[k] === index ? "" : ` (shape of ${shapes.numbers[k]})`;
    views[0].draw(drawn[k], drawn[0], `Undeformed section at ${text}${aside}, first design dashed`);
    views[1].draw(frames[k], frames[0], `Deformed section at the end of the analysis at ${text}${aside}: peak stress ${readable(frames[k].peak, 3)} kPa`);
    place("design-text").textContent = `peak ${readable(frames[k].peak, 3)} kPa; dashed: first design${aside}`;
  };
  return { views, show };
}

function iterations() {
  const { charts, count, kind } = histories(), pictures = shapes && designs();
  const { objective, violation } = history;
  const show = (index) => {
    charts.forEach((chart) => chart.cursor(index));
    const value = objective ? `${readable(objective.values[index])}${objective.unit ? ` ${objective.unit}` : ""}, ` : "";
    place("iteration-value").textContent = `${index} of ${count - 1}: ${value}violation ${readable(100 * violation[index], 3)} %`;
    if (pictures) pictures.show(index, `${kind} ${index}`);
  };
  slider("iteration", count, count - 1, show, 550);
  return pictures ? pictures.views : [];
}

document.querySelectorAll(".small-print").forEach((line) => { line.textContent = shapes ? shapes.caption : ""; });
const views = [...(shapes ? closing() : []), ...iterations()];
const redraw = () => views.forEach((view) => view.redraw());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
matchMedia("print").addEventListener("change", redraw);
window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
document.documentElement.dataset.ready = "true";
