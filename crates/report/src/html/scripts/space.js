"use strict";
// The embedding space: points in depth order on a canvas, turned by mouse, finger, keys or buttons.
const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"]
  .map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16)));
const START = { yaw: 0.6, pitch: 0.35, zoom: 1 };

function viridis(share) {
  const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const low = Math.min(Math.floor(place), VIRIDIS.length - 2);
  const mix = VIRIDIS[low].map((v, i) => Math.round(v + (VIRIDIS[low + 1][i] - v) * (place - low)));
  return `rgb(${mix.join()})`;
}

function startSpace(root) {
  const data = JSON.parse(root.querySelector("script").textContent);
  const canvas = root.querySelector("canvas");
  const said = root.querySelector(".said");
  const choice = root.querySelector("select");
  const pen = canvas.getContext("2d");
  const all = [...data.drives, ...data.people];
  const speeds = all.map((d) => d.speed);
  const [slowest, fastest] = [Math.min(...speeds), Math.max(...speeds)];
  const far = Math.max(...all.flatMap((d) => d.at.map(Math.abs)), ...data.people.flatMap((p) => p.conditions.flatMap((c) => c[1].map(Math.abs))));
  const length = Math.hypot(...data.gradient);
  const up = data.gradient.map((g) => (g / length) * far);
  const view = { ...START };
  let chosen = null;
  let named = null;
  let marks = [];

  const looks = new Map(data.looks.map(([id, label, corners]) => [id, { label, corners }]));
  const [lowest, highest, called] = data.score;
  const colour = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const along = (from, to, share) => from.map((v, i) => v + (to[i] - v) * share);

  // Screen x and y in CSS pixels, and depth: greater is nearer.
  function project([x, y, z]) {
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    const right = cy * x + sy * y;
    const deep = -sy * x + cy * y;
    const scale = (Math.min(canvas.clientWidth / 3.5, canvas.clientHeight / 3.15) / far) * view.zoom;
    return [canvas.clientWidth / 2 + right * scale, canvas.clientHeight / 2 - (cp * z + sp * deep) * scale, sp * z - cp * deep];
  }

  function line(items, points, style, width) {
    for (let i = 1; i < points.length; i++) {
      const [a, b] = [project(points[i - 1]), project(points[i])];
      items.push([(a[2] + b[2]) / 2, () => {
        pen.strokeStyle = style;
        pen.lineWidth = width;
        pen.beginPath();
        pen.moveTo(a[0], a[1]);
        pen.lineTo(b[0], b[1]);
        pen.stroke();
      }]);
    }
  }

  const pieces = (from, to, n) => Array.from({ length: n + 1 }, (_, i) => along(from, to, i / n));

  function shape(name, x, y, r) {
    pen.beginPath();
    // Corners as the figures have them: angle in degrees and distance; a circle has none.
    const corners = looks.get(name)?.corners ?? [];
    if (corners.length === 0) pen.arc(x, y, r, 0, 2 * Math.PI);
    else {
      corners.forEach(([degrees, far], i) => {
        const [px, py] = [x + far * r * Math.cos((degrees * Math.PI) / 180), y + far * r * Math.sin((degrees * Math.PI) / 180)];
        if (i === 0) pen.moveTo(px, py);
        else pen.lineTo(px, py);
      });
      pen.closePath();
    }
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.fillStyle = colour("paper");
    pen.fillRect(0, 0, width, height);
    pen.font = '13px "Maveric Sans", sans-serif';
    pen.textBaseline = "middle";
    const [ink, muted, rule, paper] = ["ink", "muted", "rule", "paper"].map(colour);
    const items = [];
    marks = [];
    const b = far * 1.05;
    for (const axis of [0, 1, 2]) {
      for (const [s, t] of [[-1, -1], [-1, 1], [1, -1], [1, 1]]) {
        const [from, to] = [-b, b].map((v) => {
          const corner = [s * b, t * b];
          corner.splice(axis, 0, v);
          return corner;
        });
        line(items, pieces(from, to, 8), rule, 1);
      }
    }
    line(items, pieces(up.map((v) => -v), up, 24), ink, 2);
    const drive = (d, ring) => {
      const [x, y, depth] = project(d.at);
      const r = 3 + (((d.score ?? lowest) - lowest) / (highest - lowest)) * 6;
      marks.push([x, y, d]);
      if (d === chosen) return;
      items.push([depth, () => {
        // Beside a chosen participant the others step back.
        pen.globalAlpha = chosen && d !== named ? 0.35 : 1;
        pen.beginPath();
        pen.arc(x, y, r, 0, 2 * Math.PI);
        pen.fillStyle = viridis((d.speed - slowest) / (fastest - slowest || 1));
        pen.fill();
        pen.lineWidth = ring ? 1.6 : 0.6;
        pen.strokeStyle = ring ? ink : paper;
        pen.stroke();
        if (d === named) {
          pen.beginPath();
          pen.arc(x, y, r + 4, 0, 2 * Math.PI);
          pen.lineWidth = 1.5;
          pen.strokeStyle = ink;
          pen.stroke();
        }
        pen.globalAlpha = 1;
      }]);
    };
    data.drives.forEach((d) => drive(d, false));
    data.people.forEach((d) => drive(d, true));
    const labels = [];
    if (chosen) {
      if (data.ellipse) {
        const round = Array.from({ length: 73 }, (_, i) => {
          const angle = (i / 72) * 2 * Math.PI;
          return chosen.at.map((v, k) => v + Math.cos(angle) * data.ellipse[0][k] + Math.sin(angle) * data.ellipse[1][k]);
        });
        line(items, round, muted, 1.2);
      }
      const placed = Object.fromEntries(chosen.conditions);
      const dialled = data.dial.map((id) => placed[id]).filter(Boolean);
      for (let i = 1; i < dialled.length; i++) line(items, pieces(dialled[i - 1], dialled[i], 10), muted, 1.2);
      for (const [name, at] of chosen.conditions) {
        const [x, y, depth] = project(at);
        // In front of everything: they are what was asked for.
        items.push([1e9 + depth, () => {
          shape(name, x, y, 6);
          pen.fillStyle = colour(`of-${name}`);
          pen.fill();
          pen.lineWidth = 1;
          pen.strokeStyle = paper;
          pen.stroke();
        }]);
        labels.push([x, y, looks.get(name)?.label ?? name]);
      }
    }
    items.sort((one, other) => one[0] - other[0]).forEach(([, paint]) => paint());
    const write = (text, x, y, align) => {
      pen.textAlign = align;
      pen.lineWidth = 3;
      pen.strokeStyle = paper;
      pen.strokeText(text, x, y);
      pen.fillStyle = ink;
      pen.fillText(text, x, y);
    };
    for (const axis of [0, 1, 2]) {
      const end = [-b, -b, -b];
      end[axis] = 0;
      const [x, y] = project(end.map((v, i) => (i === axis ? v : v * 1.12)));
      write(`w${"\u2081\u2082\u2083"[axis]}`, x, y, "center");
    }
    const tip = project(up.map((v) => v * 1.1));
    write(`higher ${called}`, Math.min(Math.max(tip[0], 55), width - 55), Math.min(Math.max(tip[1], 28), height - 12), "center");
    for (const [x, y, text] of labels) write(text, x > width - 110 ? x - 12 : x + 12, y, x > width - 110 ? "right" : "left");
    for (let i = 0; i < 60; i++) {
      pen.fillStyle = viridis(i / 59);
      pen.fillRect(8 + i * 2, 8, 2.5, 8);
    }
    write(`${slowest.toFixed(0)} to ${fastest.toFixed(0)} ${data.unit}`, 134, 12, "left");
  }

  function name(d) {
    named = d;
    if (!d) said.textContent = "Nobody is chosen.";
    else {
      const who = d.conditions ? `Participant ${d.name}` : `Drive ${d.name}`;
      const score = d.score === null ? `no ${called}` : `${called} ${d.score.toFixed(1)}`;
      said.textContent = `${who}: ${score}, mean velocity ${d.speed.toFixed(1)} ${data.unit}.`;
      if (d.conditions) chosen = d;
    }
    if (d === null || d.conditions) choice.selectedIndex = data.people.indexOf(d) + 1;
    draw();
  }

  const turn = (yaw, pitch) => {
    view.yaw += yaw;
    view.pitch = Math.min(Math.max(view.pitch + pitch, -1.5), 1.5);
    draw();
  };
  const zoom = (factor) => {
    view.zoom = Math.min(Math.max(view.zoom * factor, 0.5), 4);
    draw();
  };
  const next = () => name(data.people[(data.people.indexOf(chosen) + 1) % data.people.length] ?? null);
  const acts = {
    left: () => turn(0.15, 0), right: () => turn(-0.15, 0), up: () => turn(0, 0.12), down: () => turn(0, -0.12),
    nearer: () => zoom(1.2), away: () => zoom(1 / 1.2), next,
    back: () => { Object.assign(view, START); draw(); },
  };
  const keys = {
    ArrowLeft: "left", ArrowRight: "right", ArrowUp: "up", ArrowDown: "down", "+": "nearer", "=": "nearer", "-": "away",
    "\u2212": "away", Enter: "next", Home: "back",
  };
  root.addEventListener("click", (event) => acts[event.target.dataset?.do]?.());
  choice.addEventListener("change", () => {
    chosen = null;
    name(data.people[choice.selectedIndex - 1] ?? null);
  });
  canvas.addEventListener("keydown", (event) => {
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    acts[act]();
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = { x: event.clientX, y: event.clientY, moved: 0 };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    const [dx, dy] = [event.clientX - held.x, event.clientY - held.y];
    held = { x: event.clientX, y: event.clientY, moved: held.moved + Math.abs(dx) + Math.abs(dy) };
    if (held.moved > 3) turn(-dx * 0.01, dy * 0.01);
  });
  canvas.addEventListener("pointerup", (event) => {
    const clicked = held && held.moved <= 3;
    held = null;
    if (!clicked) return;
    const box = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const [distance, found] = marks.reduce((best, [mx, my, d]) => {
      const away = Math.hypot(mx - x, my - y);
      return away < best[0] ? [away, d] : best;
    }, [Infinity, null]);
    if (distance < 14) name(found);
  });
  canvas.addEventListener("pointercancel", () => { held = null; });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  new ResizeObserver(draw).observe(canvas);
  document.fonts.ready.then(draw);
  root.hidden = false;
  said.textContent = "Nobody is chosen.";
  draw();
}
document.querySelectorAll("[data-live=space]").forEach(startSpace);
