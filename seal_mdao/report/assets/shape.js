// Sections on a canvas: stress, outline, rigid profiles, what is held, contact.

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer), numbers = new Int16Array(bytes.length / 2);
  for (let i = 0; i < numbers.length; i++) numbers[i] = view.getInt16(2 * i, true);
  return numbers;
}

/* Draws frames of one seal.
   frame: {points: Int16Array of x, y, stress per point, profiles: [{face, body}], poses: [[x, y, cos, sin]],
   touching: Int16Array of x, y per contact point, marks: "1132.."}; boundary: Int16Array of x, y in place of points */
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
    if (this.shapes.mirrored) this.drawHalves(frame, ghost);
    else this.drawSection(frame, ghost);
    if (!frame.boundary) this.drawWatched(frame.points);
    if (this.shapes.ring) this.drawAxis();
    this.canvas.setAttribute("aria-label", name);
  }

  drawSection(frame, ghost) {
    this.drawProfiles(frame);
    this.drawHeld();
    if (ghost) this.outline(ghost, "--ghost", 1.2, [5, 4]);
    if (frame.boundary) this.fillSection(frame);
    else this.drawStress(frame.points);
    this.outline(frame, "--outline", frame.boundary ? 1.8 : 1);
    if (frame.marks) this.drawContact(frame);
  }

  // A ring near its axis: first the mirror image, below a veil.
  drawHalves(frame, ghost) {
    const { context, canvas: { width, height } } = this, axis = this.px(0);
    for (const mirrored of [true, false]) {
      context.save();
      if (mirrored) {
        context.translate(2 * axis, 0);
        context.scale(-1, 1);
      }
      context.beginPath();
      context.rect(axis, 0, width, height);
      context.clip();
      this.drawSection(frame, ghost);
      context.globalAlpha = 0.55;
      context.fillStyle = this.color("--panel");
      if (mirrored) context.fillRect(axis, 0, width, height);
      context.restore();
    }
  }

  // The axis of a ring, or how far it is from the left side of the picture.
  drawAxis() {
    const { context } = this, axis = this.px(0), height = this.canvas.clientHeight;
    context.strokeStyle = context.fillStyle = this.color("--ink");
    if (axis < 0) {
      context.font = "12px system-ui, sans-serif";
      context.textAlign = "left";
      context.textBaseline = "bottom";
      context.fillText(`← axis, ${readable(this.shapes.low[0], 3)} mm`, 4, height - 3);
      return;
    }
    context.lineWidth = 1;
    context.setLineDash([9, 3, 2, 3]);
    context.beginPath();
    context.moveTo(axis, 0);
    context.lineTo(axis, height);
    context.stroke();
    context.setLineDash([]);
  }

  path(points, more = false) {
    const { context } = this;
    if (!more) context.beginPath();
    points.forEach(([x, y], i) => (i ? context.lineTo(this.px(x), this.py(y)) : context.moveTo(this.px(x), this.py(y))));
  }

  // A profile's points where a pose puts them.
  placed(points, [x, y, cos, sin]) { return points.map(([u, v]) => [x + cos * u - sin * v, y + sin * u + cos * v]); }

  drawProfiles({ profiles, poses, ghosts }) {
    const { context } = this;
    profiles.forEach(({ face, body }, i) => {
      body.forEach((ring, k) => this.path(this.placed(ring, poses[i]), k > 0));
      context.fillStyle = this.color("--door");
      context.fill("evenodd");
      this.path(this.placed(face, poses[i]));
      context.strokeStyle = this.color("--door-line");
      context.lineWidth = 1.6;
      context.stroke();
      if (!ghosts) return;
      this.path(this.placed(ghosts[i].face, poses[i]));
      context.strokeStyle = this.color("--ghost");
      context.setLineDash([5, 4]);
      context.stroke();
      context.setLineDash([]);
    });
  }

  // Held stretches of the boundary, the section on their left, hatched on their right.
  drawHeld() {
    const { context } = this, depth = 0.03 * (this.shapes.high[0] - this.shapes.low[0]);
    context.strokeStyle = this.color("--soft");
    for (const line of this.shapes.held) {
      context.lineWidth = 1;
      for (let k = 1; k < line.length; k++) {
        const [[x, y], [u, v]] = [line[k - 1], line[k]], size = Math.hypot(u - x, v - y) || 1, count = Math.ceil(size / (0.8 * depth));
        const [s, t] = [(depth * (u - x)) / size, (depth * (v - y)) / size];
        for (let i = 0; i <= count; i++) {
          const [a, b] = [x + ((u - x) * i) / count, y + ((v - y) * i) / count];
          this.path([[a, b], [a - 0.7 * s + t, b - 0.7 * t - s]]);
          context.stroke();
        }
      }
      context.lineWidth = 1.6;
      this.path(line);
      context.stroke();
    }
  }

  drawStress(points) {
    const { quads, regions, scales, length } = this.shapes, { context, subdivide: n } = this;
    const mix = (a, b, c, d, s, t, k) => (1 - s) * ((1 - t) * points[a + k] + t * points[b + k]) + s * ((1 - t) * points[c + k] + t * points[d + k]);
    context.lineWidth = 0.7;
    for (const [a, b, c, d] of quads) {
      const at = [3 * a, 3 * b, 3 * d, 3 * c];
      // all corners belong to one material: points between two materials lie twice
      const { colours } = scales[regions[a]], last = colours.length - 1;
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

  // Closed boundaries of a frame.
  rings({ points, boundary }) {
    const { loops, length } = this.shapes;
    let first = 0;
    return loops.map((loop) => {
      const ring = loop.map((point, i) => {
        const [from, k] = boundary ? [boundary, 2 * (first + i)] : [points, 3 * point];
        return [from[k] * length, from[k + 1] * length];
      });
      first += loop.length;
      return ring;
    });
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

  fillSection(frame) {
    const { context } = this;
    this.rings(frame).forEach((ring, k) => this.path([...ring, ring[0]], k > 0));
    context.globalAlpha = 0.16;
    context.fillStyle = this.color("--accent");
    context.fill("evenodd");
    context.globalAlpha = 1;
  }

  place(points, index) {
    const { length } = this.shapes;
    return [this.px(points[3 * index] * length), this.py(points[3 * index + 1] * length)];
  }

  // Filled where a point touches, hollow where it is open between others that do.
  drawContact({ touching, marks }) {
    const { context } = this, { length } = this.shapes;
    [...marks].forEach((mark, k) => {
      context.beginPath();
      context.arc(this.px(touching[2 * k] * length), this.py(touching[2 * k + 1] * length), 3.1, 0, 2 * Math.PI);
      context.fillStyle = this.color(mark === "3" ? "--paper" : "--touch");
      context.fill();
      context.strokeStyle = this.color("--outline");
      context.lineWidth = 0.9;
      context.stroke();
    });
  }

  drawWatched(points) {
    const { context } = this, { watched } = this.shapes;
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    watched.forEach((beside, k) => {
      const index = beside[beside.length >> 1], [x, y] = this.place(points, index);
      const [ax, ay] = this.place(points, beside[0]), [bx, by] = this.place(points, beside[beside.length - 1]);
      // on screen, where y points down: the section is on the right of a to b
      const size = Math.hypot(bx - ax, by - ay) || 1, [u, v] = [-(by - ay) / size, (bx - ax) / size];
      context.fillStyle = context.strokeStyle = this.color("--ink");
      context.lineWidth = 1;
      this.context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 7 * u, y + 7 * v);
      context.stroke();
      context.fillText(String(k + 1), x + 14 * u, y + 14 * v);
    });
  }

  // The stress under the pointer, as the canvas' title.
  point(event) {
    if (!this.last || this.last[0].boundary) return;
    const box = this.canvas.getBoundingClientRect(), { points } = this.last[0];
    let best = -1, least = 8;
    for (let k = 0; k < points.length / 3; k++) {
      const [x, y] = this.place(points, k), away = Math.hypot(x - (event.clientX - box.left), y - (event.clientY - box.top));
      if (away < least) [best, least] = [k, away];
    }
    this.canvas.title = best < 0 ? "" : `${readable((points[3 * best + 2] / 32000) * this.shapes.scales[this.shapes.regions[best]].top, 3)} kPa`;
  }
}
