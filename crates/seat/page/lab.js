// The experimenter's page goes on by itself: the seat sends what has changed, and its time once a second.
const silent = document.getElementById("silent");
const people = document.getElementById("people");
/// The rows of people as they were sent.
const rows = new Map();
let heard = performance.now();

const two = (n) => String(n).padStart(2, "0");

/// Every moment as the time that has passed since.
function sayTimes(now) {
  for (const time of document.querySelectorAll("time")) {
    const s = Math.max(0, now - Number(time.dataset.since));
    time.textContent = `${Math.floor(s / 3600)}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
  }
}

const seat = new EventSource("/lab/live");
for (const part of ["refused", "happened", "disk"]) {
  seat.addEventListener(part, ({ data }) => { document.getElementById(part).innerHTML = data; });
}
// Row by row: one that somebody is about to use stays as it is until then.
seat.addEventListener("people", ({ data }) => {
  const sent = document.createElement("template");
  sent.innerHTML = data;
  const gone = new Set([...people.children].map((row) => row.id));
  for (const row of [...sent.content.children]) {
    gone.delete(row.id);
    const there = document.getElementById(row.id);
    const text = row.outerHTML;
    if (there?.contains(document.activeElement) || rows.get(row.id) === text) continue;
    rows.set(row.id, text);
    if (there) there.replaceWith(row); else people.append(row);
  }
  for (const id of gone) { rows.delete(id); document.getElementById(id).remove(); }
});
seat.addEventListener("now", ({ data }) => { heard = performance.now(); sayTimes(Number(data)); });
// The seat was opened anew and asks the password again, say: its own page tells.
seat.addEventListener("error", () => { if (seat.readyState === EventSource.CLOSED) setTimeout(() => location.reload(), 3000); });
setInterval(() => { silent.hidden = performance.now() - heard < 4000; }, 500);
