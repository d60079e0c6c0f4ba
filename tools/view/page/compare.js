// Two recordings beside each other: one scene with the probes of both, and their curves over each other.
"use strict";
(() => {
  const { sub, length } = asperity.vectors;
  const element = (id) => document.getElementById(id);
  const amount = asperity.amount, short = asperity.short;
  const colours = ["--a", "--b"], letters = ["A", "B"];

  const runsAt = (h, time) => h.size > 0 && time >= h.time(h.first) && time <= h.time(h.end - 1);
  const place = (h, row) => h.some(row, "probe_x", 3);

  // Metres between the probes, where both recordings run; nothing where one of them does not.
  function apart(page, row) {
    const [a, b] = page.histories, time = a.time(row);
    return runsAt(b, time) ? length(sub(place(a, row), place(b, b.rowAt(time)))) : NaN;
  }

  // What differs between two recordings before anybody looks at a curve.
  function differences([a, b]) {
    const out = [], seconds = (r) => r.to_s - r.from_s, rate = (r) => (r.period_s > 0 ? 1 / r.period_s : 0);
    if (Math.abs(seconds(a) - seconds(b)) > 1.5 * Math.max(a.period_s, b.period_s)) {
      out.push(`lengths differ: A ${short(seconds(a), 5)} s, B ${short(seconds(b), 5)} s`);
    }
    if (Math.abs(rate(a) - rate(b)) > 1e-3 * Math.max(rate(a), rate(b))) {
      out.push(`rates differ: A ${short(rate(a), 5)} Hz, B ${short(rate(b), 5)} Hz`);
    }
    if (Math.abs(a.from_s - b.from_s) > 1.5 * Math.max(a.period_s, b.period_s)) {
      out.push(`they begin apart: A at ${short(a.from_s, 5)} s, B at ${short(b.from_s, 5)} s`);
    }
    return out;
  }

  function open(page) {
    const recordings = page.description.recordings;
    const told = differences(recordings), note = element("differs");
    note.hidden = false;
    const names = recordings.map((r, i) => {
      const b = document.createElement("b");
      b.textContent = `${letters[i]} ${r.name}`;
      b.style.color = `var(${colours[i]})`;
      return b;
    });
    note.replaceChildren(...names, told.length > 0 ? told.join("; ") : "same length, same rate");
    element("component-label").hidden = false;
    element("ticks-title").textContent = "Probes apart";
    element("ticks").setAttribute("aria-label", "Distance between the two probes over time");
    element("spectrum-title").textContent = "Felt vibration at this time";
    element("spectrum").setAttribute("aria-label", "Spectra of the forces on the two hands at the time that is shown");
    element("energy-title").textContent = "Energy to the hand";
    for (const name of ["force", "torque"]) element(name).setAttribute("aria-label", `${name} on both hands over time`);
    for (const name of ["force", "torque", "energy", "spectrum"]) {
      asperity.legend(`${name}-legend`, letters.map((l, i) => [l, colours[i]]));
    }
  }

  function draw(page, span, cursor) {
    const component = element("component").value;
    const both = (make) => page.histories.map((history, i) => ({ history, colour: colours[i], ...make(history) }));
    const of = (name, unit, least) => both((h) => component === "size"
      ? { of: (row) => length(h.some(row, `${name}x`, 3)), unit, least }
      : { column: name + component, unit, least });
    const a = page.histories[0];
    asperity.drawCurves(element("force"), a, span, of("hand_f", "N", 0.05), cursor);
    asperity.drawCurves(element("torque"), a, span, of("hand_t", "N m", 1e-3), cursor);
    asperity.drawCurves(element("energy"), a, span, both(() => ({ column: "delivered", unit: "J", least: 1e-6 })), cursor);
    asperity.drawCurves(element("ticks"), a, span, [{ of: (row) => apart(page, row), unit: "m", colour: "--total", least: 1e-6 }], cursor);
    asperity.drawSpectra(element("spectrum"), both((h) => ({ end: h.rowAt(cursor) + 1 })), page.description.recordings.map((r) => r.period_s));
  }

  function describe(page, time) {
    const forces = page.histories.map((h) => (runsAt(h, time) ? h.some(h.rowAt(time), "hand_fx", 3) : null));
    const parts = forces.map((f, i) => `${letters[i]} ${f === null ? "does not run" : amount(length(f), "N")}`);
    if (forces.every((f) => f !== null)) {
      const between = apart(page, page.histories[0].rowAt(time));
      parts.push(`forces differ by ${amount(length(sub(...forces)), "N")}`, `probes ${amount(between, "m")} apart`);
    }
    page.compared = { forces: forces.map((f) => (f === null ? null : Array.from(f))) };
    element("readout").textContent = parts.join("   ");
  }

  asperity.compare = { open, draw, describe, colours, runsAt, differences };
})();
