// What the page tells of its models: which parts can be hidden, and the table below the scene.
"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const amount = asperity.amount;

  // `boxes`: names and labels of what can be hidden.
  asperity.listParts = (page, boxes) => {
    element("parts").replaceChildren(...boxes.map(([name, label]) => {
      const line = document.createElement("label"), box = document.createElement("input");
      box.type = "checkbox";
      box.checked = page.shown[name];
      box.dataset.part = name;
      box.addEventListener("change", () => { page.shown[name] = box.checked; page.changed = true; });
      line.append(box, label);
      return line;
    }));
    document.querySelector(".parts").hidden = boxes.length === 0;
  };

  asperity.listFacts = (description) => {
    const table = element("facts"), rows = [["model", "shown", "coarse", "pieces", "texture", "error (rms, most)"]];
    const told = new Set();
    for (const b of description.bodies) {
      if (told.has(b.mesh)) continue;
      told.add(b.mesh);
      const f = b.facts, thousands = (n) => (n >= 10000 ? `${Math.round(n / 1000)} k` : String(n));
      const less = f.texels > 1.2 * b.points ? ` points for ${thousands(f.texels)} texels, ${amount(b.step_m, "m")} apart` : " points, all texels";
      rows.push([b.name, thousands(b.points) + less, `${f.coarse_triangles} triangles`, String(f.pieces), f.texture.join(" \u00d7 "),
                 `${amount(f.rms_error_m, "m")}, ${amount(f.max_error_m, "m")}`]);
    }
    table.replaceChildren(...rows.map((cells, i) => {
      const line = document.createElement("tr");
      line.append(...cells.map((text) => Object.assign(document.createElement(i === 0 ? "th" : "td"), { textContent: text })));
      return line;
    }));
  };
})();
