// Events of gate, device and contact: what changed from one row to the next.
"use strict";
(() => {
  const list = () => document.getElementById("events");

  function add(page, time, text, bad) {
    const item = document.createElement("li");
    item.textContent = `${time.toFixed(3)} s  ${text}`;
    if (bad) item.dataset.level = "bad";
    list().prepend(item);
    ++page.events;
    while (list().children.length > 200) list().lastChild.remove();
  }

  function find(page, h, seen, add) {
    const n = page.description.names;
    if (seen.row > h.end) Object.assign(seen, { row: h.first, device: -1 });
    const missedBefore = seen.missed ?? 0;
    if (h.missed > missedBefore) add(h.time(h.end - 1), `${h.missed - missedBefore} ticks were not drawn`, false);
    seen.missed = h.missed;
    for (let row = Math.max(seen.row, h.first); row < h.end; ++row) {
      const time = h.time(row), of = (name) => h.value(row, h.column[name]);
      const fault = of("fault"), device = of("device"), flags = of("flags"), sample = of("sample");
      if (fault !== seen.fault) add(time, fault === 0 ? "gate open" : `gate shut: ${n.fault[fault]}`, fault !== 0);
      if (device !== seen.device && seen.device >= 0) add(time, `device ${n.device[device]}`, n.device[device] === "fault");
      for (let bit = 0; bit < 8; ++bit) {
        if (((flags & ~seen.flags) >> bit) & 1) add(time, `planes: ${n.flags[bit].replaceAll("_", " ")}`, true);
      }
      if (sample !== seen.sample && sample !== 0) add(time, `sample: ${n.sample[sample]}`, true);
      const touches = of("contacts") > 0;
      if (touches && !seen.touches && time - (seen.let ?? -1) > 0.05) add(time, "touches", false);
      if (!touches && seen.touches) seen.let = time;
      Object.assign(seen, { fault, device, flags, sample, touches });
    }
    seen.row = h.end;
  }

  // Lists what is new since the last call. Of two recordings the events stand among each other, by their times.
  asperity.findEvents = (page) => {
    if (page.histories.length === 1) {
      find(page, page.histories[0], page.seen[0], (...event) => add(page, ...event));
      return;
    }
    const found = [];
    page.histories.forEach((h, i) => find(page, h, page.seen[i], (time, text, bad) => found.push([time, `${"AB"[i]}  ${text}`, bad])));
    found.sort((a, b) => a[0] - b[0]).forEach((event) => add(page, ...event));
  };
  asperity.nothingSeen = () => ({ row: 0, fault: 0, device: -1, flags: 0, sample: 0 });
})();
