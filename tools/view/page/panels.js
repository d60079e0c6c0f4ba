// The panels of a session, what its numbers read, and the files that people take along.
"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const amount = asperity.amount;

  asperity.legend = (id, entries) => {
    const text = entries.map(([label, colour]) => `${colour}|${label}`).join();
    if (element(id).dataset.text === text) return;
    element(id).dataset.text = text;
    element(id).replaceChildren(...entries.map(([label, colour]) => {
      const b = document.createElement("b");
      b.textContent = label;
      if (colour) b.style.color = `var(${colour})`;
      return b;
    }));
  };

  asperity.drawPanels = (page, span, cursor) => {
    const h = page.history, legend = asperity.legend;
    const three = (name, unit, least) => ["x", "y", "z"].map((axis) => ({ column: `${name}${axis}`, unit, colour: `--${axis}`, least }));
    asperity.drawCurves(element("force"), h, span, three("hand_f", "N", 0.05), cursor);
    asperity.drawCurves(element("torque"), h, span, three("hand_t", "N m", 1e-3), cursor);
    asperity.drawCurves(element("energy"), h, span, [{ column: "delivered", unit: "J", colour: "--total", least: 1e-6 },
                                                     { column: "surplus", unit: "J", colour: "--x" }], cursor);
    const axes = [["x", "--x"], ["y", "--y"], ["z", "--z"]];
    legend("force-legend", axes);
    legend("torque-legend", axes);
    legend("energy-legend", [["to the hand", "--total"], ["surplus", "--x"]]);
    page.spectrogram.draw(element("spectrum"), h, span, cursor, page.description.device_period_s);
    legend("spectrum-legend", [["1 mN to 1 N", ""]]);
    const t = asperity.drawTicks(element("ticks"), h, span, page.description.device_period_s);
    page.ticks = t;
    legend("ticks-legend", t === null ? [["not measured", ""]]
      : [[`p50 ${amount(t.p50, "s")}`, ""], [`p99 ${amount(t.p99, "s")}`, ""], [`${t.late} late`, t.late > 0 ? "--late" : ""]]);
  };

  asperity.save = (name, blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };

  // Of two recordings each row says whose it is.
  asperity.csvOf = (span) => {
    const { histories, description } = asperity.page, columns = description.columns;
    const both = histories.length > 1;
    const lines = [[...(both ? ["recording"] : []), "time_s", ...columns].join()];
    histories.forEach((h, i) => {
      if (h.size === 0 || h.time(h.end - 1) < span.from) return;
      for (let row = h.rowAt(span.from); row < h.end && h.time(row) <= span.to; ++row) {
        lines.push([...(both ? ["AB"[i]] : []), h.time(row), ...h.some(row, columns[0], columns.length)].join());
      }
    });
    return lines.join("\n") + "\n";
  };
})();
