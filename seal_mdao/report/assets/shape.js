// Sections on a canvas: stress, outline, door, base, contact.

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer), numbers = new Int16Array(bytes.length / 2);
  for (let i = 0; i < numbers.length; i++) numbers[i] = view.getInt16(2 * i, true);
  return numbers;
}

// Stretch of open points between the first and the last one in contact.
function opened(state) {
  const first = state.search(/[12]/), last = Math.max(state.lastIndexOf("1"), state.lastIndexOf("2"));
  return [...state].map((s, i) => s === "0" && first >= 0 && i > first && i < last);
}

/* Draws frames of one seal.
   frame: {points: Int16Array of x, y, stress per point, door: [[x, y]], position: [x, y], state: "0012.."} */
class ShapeView {
  constructor(canvas, shapes) {
    Object.assign(this, { canvas, shapes, subdivide: 3 });
    this.context = canvas.getContext("2d");
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("pointerleave", () => { this.canvas.title = ""; });
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  redraw() { if (this.last) this.draw(...this.last); }

  prepare() {
    const { low, high } = this.shapes, ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth || 480, height = (width * (high[1] - low[1])) / (high[0] - low[0]);
    this.canvas.style.height = `${height}px`;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.zoom = width / (high[0] - low[0]);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.style = getComputedStyle(this.canvas);
  }

  color(name) { return this.style.getPropertyValue(name).trim(); }
  px(x) { return (x - this.shapes.low[0]) * this.zoom; }
  py(y) { return (this.shapes.high[1] - y) * this.zoom; }

  draw(frame, ghost, name) {
    this.last = [frame, ghost, name];
    this.prepare();
    this.drawDoor(frame);
    this.drawBase();
    if (ghost) this.outline(ghost, "--ghost", 1.2, [5, 4]);
    if (frame.stressed === false) this.fillWall(frame);
    else this.drawStress(frame.points);
    this.outline(frame, "--outline", frame.stressed === false ? 1.8 : 1);
    if (frame.state) this.drawContact(frame);
    if (frame.stressed !== false) this.drawWatched(frame.points);
    this.canvas.setAttribute("aria-label", name);
  }

  path(points) {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y], i) => (i ? context.lineTo(this.px(x), this.py(y)) : context.moveTo(this.px(x), this.py(y))));
  }

  drawDoor({ door, position, doorGhost }) {
    if (!door) return;
    const { context } = this, moved = door.map(([x, y]) => [x + position[0], y + position[1]]);
    this.path([...moved, [moved[moved.length - 1][0], 1e3], [moved[0][0], 1e3]]);
    context.fillStyle = this.color("--door");
    context.fill();
    this.path(moved);
    context.strokeStyle = this.color("--door-line");
    context.lineWidth = 1.6;
    context.stroke();
    if (!doorGhost) return;
    this.path(doorGhost.map(([x, y]) => [x + position[0], y + position[1]]));
    context.strokeStyle = this.color("--ghost");
    context.setLineDash([5, 4]);
    context.stroke();
    context.setLineDash([]);
  }

  drawBase() {
    const { context } = this, [left, right, y] = this.shapes.base;
    context.strokeStyle = this.color("--soft");
    context.lineWidth = 1;
    for (let x = left - 0.6; x < right + 0.6; x += 0.5) {
      this.path([[x, y - 0.6], [x + 0.5, y]]);
      context.stroke();
    }
    context.lineWidth = 1.6;
    this.path([[left - 0.8, y], [right + 0.8, y]]);
    context.stroke();
  }

  drawStress(points) {
    const { around, across, length, colours } = this.shapes, { context, subdivide: n } = this;
    const last = colours.length - 1, corner = (i, j) => 3 * ((i % around) * across + j);
    const mix = (a, b, c, d, s, t, k) => (1 - s) * ((1 - t) * points[a + k] + t * points[b + k]) + s * ((1 - t) * points[c + k] + t * points[d + k]);
    context.lineWidth = 0.7;
    for (let i = 0; i < around; i++) {
      for (let j = 0; j < across - 1; j++) {
        const at = [corner(i, j), corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1)];
        for (let s = 0; s < n; s++) {
          for (let t = 0; t < n; t++) {
            const level = mix(...at, (s + 0.5) / n, (t + 0.5) / n, 2) / 32000;
            context.fillStyle = context.strokeStyle = colours[Math.max(0, Math.min(last, Math.round(level * last)))];
            context.beginPath();
            for (const [u, v] of [[s, t], [s + 1, t], [s + 1, t + 1], [s, t + 1]]) {
              context.lineTo(this.px(mix(...at, u / n, v / n, 0) * length), this.py(mix(...at, u / n, v / n, 1) * length));
            }
            context.closePath();
            context.fill();
            context.stroke();
          }
        }
      }
    }
  }

  // Inner and outer boundary of a frame, whose rows have `across` points of `width` numbers.
  rings({ points, across = this.shapes.across, width = 3 }) {
    const { around, length } = this.shapes, rows = Array.from({ length: around }, (_, i) => i * across);
    const place = (k) => [points[k] * length, points[k + 1] * length];
    return [0, across - 1].map((j) => rows.map((row) => place(width * (row + j))));
  }

  outline(frame, color, line, dash = []) {
    const { context } = this;
    context.strokeStyle = this.color(color);
    context.lineWidth = line;
    context.setLineDash(dash);
    for (const ring of this.rings(frame)) {
      this.path(ring);
      context.closePath();
      context.stroke();
    }
    context.setLineDash([]);
  }

  fillWall(frame) {
    const { context } = this, [inner, outer] = this.rings(frame);
    this.path([...outer, outer[0], inner[0], ...inner.reverse()]);
    context.closePath();
    context.globalAlpha = 0.16;
    context.fillStyle = this.color("--accent");
    context.fill();
    context.globalAlpha = 1;
  }

  place(points, index) {
    const { length } = this.shapes;
    return [this.px(points[3 * index] * length), this.py(points[3 * index + 1] * length)];
  }

  drawContact({ points, state }) {
    const { context } = this, open = opened(state);
    this.shapes.contact.forEach((index, k) => {
      if (state[k] === "0" && !open[k]) return;
      context.beginPath();
      context.arc(...this.place(points, index), 3.1, 0, 2 * Math.PI);
      context.fillStyle = open[k] ? this.color("--paper") : this.color("--touch");
      context.fill();
      context.strokeStyle = this.color("--outline");
      context.lineWidth = 0.9;
      context.stroke();
    });
  }

  drawWatched(points) {
    const { context } = this, { across, watched } = this.shapes;
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    watched.forEach((index, k) => {
      const [x, y] = this.place(points, index), row = Math.floor(index / across) * across, outer = index % across !== 0;
      const [ix, iy] = this.place(points, row), [ox, oy] = this.place(points, row + across - 1);
      const size = Math.hypot(ox - ix, oy - iy) || 1, way = (outer ? 1 : -1) / size;
      context.fillStyle = context.strokeStyle = this.color("--ink");
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 7 * way * (ox - ix), y + 7 * way * (oy - iy));
      context.stroke();
      context.fillText(String(k + 1), x + 14 * way * (ox - ix), y + 14 * way * (oy - iy));
    });
  }

  // The stress under the pointer, as the canvas' title.
  point(event) {
    if (!this.last || this.last[0].stressed === false) return;
    const box = this.canvas.getBoundingClientRect(), { points } = this.last[0];
    let best = -1, least = 8;
    for (let k = 0; k < points.length / 3; k++) {
      const [x, y] = this.place(points, k), away = Math.hypot(x - (event.clientX - box.left), y - (event.clientY - box.top));
      if (away < least) [best, least] = [k, away];
    }
    this.canvas.title = best < 0 ? "" : `${readable(points[3 * best + 2] * this.shapes.stress, 3)} kPa`;
  }
}
