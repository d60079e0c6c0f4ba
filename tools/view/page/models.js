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

  // Only a model by itself can be coloured by its distance to the full mesh, which is not in the model: where it was not
  // given, the choice says how to.
  asperity.offerErrors = (description) => {
    const option = element("colours").querySelector("[value=error]");
    if (description.mode !== "model") return;
    option.hidden = false;
    option.disabled = description.bodies.every((b) => b.error_m === null);
    if (option.disabled) option.textContent = "distance to the full mesh: give it with --original";
  };

  // What the colours of the surface stand for.
  asperity.showValues = (page) => {
    const paint = page.scene.paint, body = page.description.bodies.find((b) => !b.probe) ?? page.description.bodies[0];
    const shown = paint === "relief" ? { text: "height over the coarse mesh", stops: asperity.aboutZeroShown, range: body.relief_m, beyond: "" }
      : paint === "error" && body.error_m ? { text: "distance to the full mesh", stops: asperity.heat, range: [0, body.error_m.high],
                                              beyond: body.error_m.largest > body.error_m.high ? "\u2265 " : "" } : null;
    element("values").hidden = shown === null;
    if (shown === null) return;
    const several = page.description.bodies.some((b) => b.mesh !== body.mesh);
    const g = element("values-bar").getContext("2d"), fill = g.createLinearGradient(0, 0, 160, 0);
    const [low, high] = shown.range, zero = paint === "relief" && high > low ? -low / (high - low) : 0.5;
    shown.stops.forEach((c, i) => {
      const at = i / (shown.stops.length - 1);
      fill.addColorStop(Math.max(0, Math.min(1, at <= 0.5 ? 2 * at * zero : zero + (2 * at - 1) * (1 - zero))), `rgb(${c.join()})`);
    });
    g.fillStyle = fill;
    g.fillRect(0, 0, 160, 8);
    element("values-text").textContent = shown.text + (several ? ` of ${body.name}` : "");
    element("values-low").textContent = amount(low, "m", 2);
    element("values-high").textContent = shown.beyond + amount(high, "m", 2);
    element("values").setAttribute("aria-label", `Colours: ${shown.text}, from ${amount(low, "m", 2)} to ${amount(high, "m", 2)}`);
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
      if (b.error_m) rows.push([`${b.name} as shown`, "distance to the full mesh", "", "", "", `${amount(b.error_m.rms, "m")}, ${amount(b.error_m.largest, "m")}`]);
    }
    table.replaceChildren(...rows.map((cells, i) => {
      const line = document.createElement("tr");
      line.append(...cells.map((text) => Object.assign(document.createElement(i === 0 ? "th" : "td"), { textContent: text })));
      return line;
    }));
  };
})();
