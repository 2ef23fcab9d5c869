// The experimenter's page goes on by itself: what may have changed is asked for again.
const live = document.getElementById("live");
const silent = document.getElementById("silent");
setInterval(async () => {
  try {
    const reply = await fetch("/lab/live");
    silent.hidden = reply.ok;
    if (reply.ok && !live.contains(document.activeElement)) live.innerHTML = await reply.text();
  } catch {
    silent.hidden = false;
  }
}, 1500);
