(() => {
  "use strict";
  const clock = (s) => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;

  // Columns come as differences, zigzag, seven bits a byte with the lowest first.
  const columns = (text) => {
    const raw = atob(text);
    let at = 0;
    const next = () => {
      let value = 0, times = 1, byte;
      do {
        byte = raw.charCodeAt(at++);
        value += (byte & 127) * times;
        times *= 128;
      } while (byte > 127);
      return value % 2 ? -(value + 1) / 2 : value / 2;
    };
    return (count, quantum, order) => {
      const out = new Float64Array(count);
      let value = 0, slope = 0;
      for (let i = 0; i < count; i++) {
        if (order === 2) { slope += next(); value += slope; } else { value += next(); }
        out[i] = value * quantum;
      }
      return out;
    };
  };

  const unpack = (data) => {
    const column = columns(data.bytes);
    const runs = data.runs.map(([first, count]) => ({
      first, count, x: column(count, 0.01, 2), y: column(count, 0.01, 1), v: column(count, 0.01, 1), gap: column(count, 0.1, 1),
    }));
    const cars = data.cars.map(([id, first, count, length, width]) => ({
      id, first, count, length, width, x: column(count, 0.01, 2), y: column(count, 0.01, 1),
    }));
    let line = null;
    if (data.line) {
      const [start, step, count] = data.line;
      line = { start, step, count, east: column(count, 0.01, 2), north: column(count, 0.01, 2) };
    }
    return { ...data, runs, cars, line };
  };

  const at = (values, i) => {
    const a = Math.max(0, Math.min(values.length - 1, Math.floor(i)));
    const b = Math.min(values.length - 1, a + 1);
    return values[a] + Math.max(0, Math.min(1, i - a)) * (values[b] - values[a]);
  };
  const within = (run, k) => k >= run.first - 1e-6 && k <= run.first + run.count - 1 + 1e-6;
  const heading = (run, i) => {
    const dx = at(run.x, i + 1) - at(run.x, i - 1), dy = at(run.y, i + 1) - at(run.y, i - 1);
    return Math.hypot(dx, dy) < 0.2 ? 0 : Math.atan2(dy, dx);
  };
  const stepped = (pairs, k) => {
    let low = 0, high = pairs.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (pairs[middle][0] <= k) low = middle; else high = middle;
    }
    return pairs.length ? pairs[low][1] : -1;
  };

  // Where a curved road lies: east, north and heading of the line y = 0 at x.
  const onLine = (line, x) => {
    const place = (x - line.start) / line.step;
    const i = Math.max(0, Math.min(line.count - 2, Math.floor(place)));
    const f = place - i;
    const clamp = (j) => Math.max(0, Math.min(line.count - 1, j));
    const turn = (j) => {
      const a = clamp(j - 1), b = clamp(j + 1);
      return Math.atan2(line.north[b] - line.north[a], line.east[b] - line.east[a]);
    };
    const from = turn(i);
    let bend = turn(i + 1) - from;
    bend -= 2 * Math.PI * Math.round(bend / (2 * Math.PI));
    return [
      line.east[i] + f * (line.east[i + 1] - line.east[i]),
      line.north[i] + f * (line.north[i + 1] - line.north[i]),
      from + Math.max(0, Math.min(1, f)) * bend,
    ];
  };
  const viewFrom = (drive, x0) => {
    if (!drive.line) return (x, y) => [x - x0, y - drive.middle, 0];
    const map = (x, y) => {
      const [e, n, h] = onLine(drive.line, x);
      return [e - y * Math.sin(h), n + y * Math.cos(h), h];
    };
    const here = map(x0, drive.middle), sin = Math.sin(here[2]), cos = Math.cos(here[2]);
    return (x, y) => {
      const [e, n, h] = map(x, y), dx = e - here[0], dy = n - here[1];
      return [dx * cos + dy * sin, dy * cos - dx * sin, h - here[2]];
    };
  };

  const BODY = [[-0.5, -0.5], [0.36, -0.5], [0.5, -0.28], [0.5, 0.28], [0.36, 0.5], [-0.5, 0.5]];
  const GLASS = [[0.08, -0.36], [0.24, -0.42], [0.24, 0.42], [0.08, 0.36]];

  const paint = (row, data, colours, k) => {
    const { canvas, drive } = row;
    const width = row.width, dpr = window.devicePixelRatio || 1;
    const span = Math.max(90, Math.min(200, width / 4.4)), scale = width / span, across = scale * drive.stretch;
    const height = Math.round(2 * drive.half * across);
    if (canvas.width !== Math.round(width * dpr) || canvas.height !== Math.round(height * dpr)) {
      canvas.width = Math.round(width * dpr);
      canvas.height = Math.round(height * dpr);
      canvas.style.height = `${height}px`;
    }
    const c = canvas.getContext("2d");
    c.setTransform(dpr, 0, 0, dpr, 0, 0);
    c.clearRect(0, 0, width, height);
    const run = drive.runs.find((r) => within(r, k));
    if (!run) return;
    const i = k - run.first, x = at(run.x, i), y = at(run.y, i);
    const behind = span * (1 - data.ahead), see = viewFrom(drive, x);
    const place = (px, py) => {
      const [ahead, left] = see(px, py);
      return [(ahead + behind) * scale, (drive.half - left) * across];
    };
    const trace = (points) => {
      c.beginPath();
      points.forEach(([px, py], j) => (j ? c.lineTo(px, py) : c.moveTo(px, py)));
    };
    const from = x - behind - 5, to = x + span - behind + 5, step = drive.line ? 5 : to - from;
    const along = (py) => {
      const points = [];
      for (let px = from; px < to + step / 2; px += step) points.push(place(px, py));
      return points;
    };
    const edge = (n) => (n - 0.5) * drive.laneWidth;
    trace([...along(edge(0)), ...along(edge(drive.lanes)).reverse()]);
    c.fillStyle = colours.tarmac;
    c.fill();
    c.strokeStyle = colours.line;
    c.lineWidth = 1.5;
    for (const n of [0, drive.lanes]) { trace(along(edge(n))); c.stroke(); }
    for (let n = 1; n < drive.lanes; n++) {
      for (let px = Math.floor(from / 12) * 12; px < to; px += 12) {
        trace([place(px, edge(n)), place(px + 3, edge(n))]);
        c.stroke();
      }
    }
    const path = [];
    for (let s = -20; s <= 20; s++) {
      if (i + s >= 0 && i + s <= run.count - 1) path.push(place(at(run.x, i + s), at(run.y, i + s)));
    }
    trace(path);
    c.strokeStyle = row.colour;
    c.lineWidth = 2;
    c.lineCap = "round";
    c.setLineDash([1.5, 4.5]);
    c.stroke();
    c.setLineDash([]);
    c.lineCap = "butt";
    const lead = stepped(drive.references, k);
    const car = (px, py, turn, [length, wide], fill, glass) => {
      const [cx, cy] = place(px, py), angle = see(px, py)[2] + turn, sin = Math.sin(angle), cos = Math.cos(angle);
      const shape = (corners) => corners.map(([a, b]) => {
        const ax = a * length, by = b * wide;
        return [cx + (ax * cos - by * sin) * scale, cy - (ax * sin + by * cos) * across];
      });
      trace(shape(BODY));
      c.closePath();
      c.fillStyle = fill;
      c.fill();
      c.strokeStyle = colours.outline;
      c.lineWidth = 1;
      c.stroke();
      trace(shape(GLASS));
      c.closePath();
      c.fillStyle = glass;
      c.fill();
      return [cx + length / 2 * scale, cy];
    };
    const labels = [];
    for (const other of drive.cars) {
      if (!within(other, k)) continue;
      const j = k - other.first, ox = at(other.x, j), oy = at(other.y, j), isLead = other.id === lead;
      if (isLead && ox - x > (other.length + drive.ego[0]) / 2) {
        trace([place(x + drive.ego[0] / 2, y), place(ox - other.length / 2, y)]);
        c.strokeStyle = colours.ink;
        c.lineWidth = 1;
        c.stroke();
      }
      const front = car(ox, oy, heading(other, j), [other.length, other.width], isLead ? colours.lead : colours.car, isLead ? colours.tarmac : colours.line);
      const near = Math.min(other.count - 2, Math.max(0, Math.floor(j)));
      if (other.count > 1) labels.push([front, (other.x[near + 1] - other.x[near]) * data.rate * data.unit.perMps]);
    }
    const front = car(x, y, heading(run, i), drive.ego, row.colour, colours.tarmac);
    if (width < 520) return;
    labels.push([front, at(run.v, i) * data.unit.perMps]);
    c.font = `11px ${row.font}`;
    c.textBaseline = "middle";
    for (const [[fx, fy], speed] of labels) {
      const text = Math.round(speed).toString(), wide = c.measureText(text).width;
      c.fillStyle = colours.tarmac;
      c.fillRect(fx + 2.5, fy - 6, wide + 3, 12);
      c.fillStyle = colours.ink;
      c.fillText(text, fx + 4, fy + 0.5);
    }
  };

  const ASIDE_M = 1.8;
  const DOING = { left: "changing to the left", right: "changing to the right", safety: "safety layer brakes" };
  const words = (drive, k, unit) => {
    const run = drive.runs.find((r) => within(r, k));
    if (!run) return "no recording here";
    const i = Math.max(0, Math.min(run.count - 1, Math.round(k - run.first))), gap = run.gap[i];
    const doing = drive.events.filter(([from, to]) => k >= from && k <= to).map((e) => DOING[e[2]]);
    // Half a lane to the side is another lane: what is passed is not ahead.
    const lead = stepped(drive.references, k), other = drive.cars.find((o) => o.id === lead && within(o, k));
    const aside = other && Math.abs(at(other.y, k - other.first) - at(run.y, k - run.first)) > ASIDE_M;
    let where = `${Math.round(gap)} m to the car ${aside ? "in the other lane" : "ahead"}`;
    if (gap < -3000) where = "nobody to follow";
    else if (Math.abs(gap) < 0.5) where = "beside the other car";
    else if (gap < 0) where = `${Math.round(-gap)} m past the car`;
    return [`${Math.round(run.v[i] * unit.perMps)} ${unit.name}`, where, ...doing].join(", ");
  };

  const start = (root) => {
    const data = JSON.parse(root.querySelector(".pl-data").textContent);
    const find = (name) => root.querySelector(name);
    const rows = [...root.querySelectorAll(".pl-row")].map((element, n) => ({
      element, drive: unpack(data.drives[n]), canvas: element.querySelector("canvas"), now: element.querySelector(".pl-now"),
      head: element.querySelector(".pl-head"), track: element.querySelector(".pl-track"), label: element.querySelector("b").textContent, width: 0,
    }));
    const [play, scrub, shown, live] = [".pl-play", ".pl-scrub input", ".pl-clock", ".pl-live"].map(find);
    const still = window.matchMedia("(prefers-reduced-motion: reduce)");
    const starts = [...new Set(data.drives.flatMap((d) => d.events.map((e) => Math.max(0, e[0] / data.rate - 1))))].sort((a, b) => a - b);
    let time = data.moment / data.rate, times = 4, playing = false, last = 0, colours = {}, saying = 0;

    const dress = () => {
      const style = getComputedStyle(root);
      for (const name of ["ink", "tarmac", "line", "car", "lead", "outline"]) colours[name] = style.getPropertyValue(`--pl-${name}`).trim();
      for (const row of rows) {
        row.colour = getComputedStyle(row.element).getPropertyValue("--pl-colour").trim();
        row.font = style.fontFamily;
      }
    };
    const draw = () => {
      const share = `${(100 * time / data.duration).toFixed(3)}%`;
      for (const row of rows) {
        const text = words(row.drive, time * data.rate, data.unit);
        if (row.now.textContent !== text) row.now.textContent = text;
        row.head.style.left = share;
        if (row.width > 0) paint(row, data, colours, time * data.rate);
      }
      if (document.activeElement !== scrub || Number(scrub.value) !== time) scrub.value = time;
      shown.textContent = `${clock(time)} of ${clock(data.duration)}`;
      scrub.setAttribute("aria-valuetext", `${clock(time)} of ${clock(data.duration)}`);
    };
    const say = () => {
      clearTimeout(saying);
      saying = setTimeout(() => {
        live.textContent = `${clock(time)}. ${rows.map((r) => `${r.label}: ${words(r.drive, time * data.rate, data.unit)}`).join(". ")}.`;
      }, 400);
    };
    const seek = (to) => {
      time = Math.max(0, Math.min(data.duration, to));
      draw();
      if (!playing) say();
    };
    const set = (on) => {
      playing = on && time < data.duration;
      play.textContent = playing ? "Pause" : "Play";
      last = 0;
      if (playing) requestAnimationFrame(frame);
      else say();
    };
    // With reduced motion the picture changes once a second instead of moving.
    const frame = (now) => {
      if (!playing) return;
      const passed = last ? (now - last) / 1000 : 0, rest = still.matches ? 1 : 0;
      if (!last || passed >= rest) {
        last = now;
        time = Math.min(data.duration, time + Math.min(passed, Math.max(0.25, rest)) * times);
        draw();
        if (time >= data.duration) { set(false); return; }
      }
      requestAnimationFrame(frame);
    };
    const toggle = () => {
      if (!playing && time >= data.duration) time = 0;
      set(!playing);
    };

    play.addEventListener("click", toggle);
    for (const button of root.querySelectorAll("[data-times]")) {
      button.addEventListener("click", () => {
        times = Number(button.dataset.times);
        for (const other of root.querySelectorAll("[data-times]")) other.setAttribute("aria-pressed", String(other === button));
      });
    }
    scrub.addEventListener("input", () => seek(Number(scrub.value)));
    find(".pl-back").addEventListener("click", () => seek(starts.filter((s) => s < time - 0.3).pop() ?? 0));
    find(".pl-on").addEventListener("click", () => seek(starts.find((s) => s > time + 0.3) ?? data.duration));
    for (const { track } of rows) {
      const to = (event) => {
        const box = track.getBoundingClientRect();
        seek((event.clientX - box.left) / box.width * data.duration);
      };
      track.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        track.setPointerCapture(event.pointerId);
        to(event);
        scrub.focus({ preventScroll: true });
        event.preventDefault();
      });
      track.addEventListener("pointermove", (event) => { if (event.buttons & 1) to(event); });
    }
    root.addEventListener("keydown", (event) => {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const onButton = event.target instanceof HTMLButtonElement, step = event.shiftKey ? 1 : 5;
      const keys = { ArrowLeft: () => seek(time - step), ArrowRight: () => seek(time + step), Home: () => seek(0), End: () => seek(data.duration) };
      if (!onButton) keys[" "] = toggle;
      if (event.target.closest(".pl-scroll") || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { dress(); draw(); });
    window.addEventListener("beforeprint", () => { set(false); seek(data.moment / data.rate); });
    new ResizeObserver(() => {
      for (const row of rows) row.width = row.canvas.parentElement.clientWidth;
      draw();
    }).observe(find(".pl-rows"));

    for (const element of root.querySelectorAll("canvas, .pl-controls, .pl-keys")) element.hidden = false;
    root.classList.add("pl-ready");
    for (const row of rows) row.width = row.canvas.parentElement.clientWidth;
    dress();
    draw();
    if (document.fonts) document.fonts.ready.then(draw);
  };
  for (const root of document.querySelectorAll(".drive-player:not(.pl-ready)")) start(root);
})();
