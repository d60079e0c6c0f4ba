// The page itself: what its data mean, its switches, and what is drawn when.
"use strict";
(() => {
  const { add, sub, times, length, turn } = asperity.vectors;
  const element = (id) => document.getElementById(id);
  const amount = asperity.amount;
  const parts = [["probe", "Probe"], ["bodies", "Fixed bodies"], ["hand", "Hand"], ["coupling", "Coupling"],
                 ["contacts", "Contact points"], ["planes", "Support planes"], ["force", "Force on the hand"],
                 ["torque", "Torque on the hand"], ["probe_force", "Force on the probe"]];
  const page = {
    description: null, scene: null, history: null, live: null, spectrogram: new asperity.Spectrogram(),
    shown: Object.fromEntries(parts.map(([name]) => [name, name !== "probe_force"])),
    at: null,        // time that is shown; null: the newest
    scaleForce: 1, scaleTorque: 1, contacts: [], seen: { row: 0, fault: 0, device: -1, flags: 0, sample: 0, contacts: 0 },
    paused: false, over: false, speed: 1, events: 0, turning: false, changed: true, lastPlots: 0, frames: 0,
  };
  asperity.page = page;

  // --- what is shown at a time
  const newestTime = () => (page.history.size > 0 ? page.history.time(page.history.end - 1) : 0);
  const shownTime = () => (page.at === null ? newestTime() : page.at);

  function range() {
    const history = page.history, span = Number(element("span").value), oldest = history.size > 0 ? history.time(history.first) : 0;
    if (span === 0) return { from: oldest, to: newestTime() };
    const to = page.at === null ? newestTime() : Math.min(newestTime(), page.at + span / 2);
    return { from: Math.max(oldest, to - span), to: Math.max(to, Math.min(newestTime(), oldest + span)) };
  }

  function pose(row, name) {
    const v = Array.from(page.history.some(row, `${name}_x`, 7));
    return { p: v.slice(0, 3), q: v.slice(3) };
  }

  // Everything of one row that the scene draws. Wrenches are newtons in world axes.
  function stateAt(row) {
    const c = page.description.bodies[0].centre_of_mass;
    const probe = pose(row, "probe"), target = pose(row, "target");
    const centre = (at) => add(at.p, turn(at.q, c));
    const vector = (name) => Array.from(page.history.some(row, name, 3));
    const toWorld = (v) => turn(page.description.device_axes, v);
    return {
      row, probe: { ...probe, centre: centre(probe) }, target: { ...target, centre: centre(target) },
      hand: { force: toWorld(vector("hand_fx")), torque: toWorld(vector("hand_tx")) },
      contact: { force: vector("contact_fx"), torque: vector("contact_tx") },
      scale: { force: page.scaleForce, torque: page.scaleTorque }, shown: page.shown,
      contacts: page.at === null ? page.contacts : [],
    };
  }

  // Metres of an arrow for a newton: so that the largest force of the last seconds is a third of the scene. Steps of two
  // and five, so that arrows do not breathe with the force.
  function chooseScale(span) {
    const history = page.history;
    let force = 0, torque = 0;
    for (let row = history.rowAt(span.from); row < history.end && history.time(row) <= span.to; row += 7) {
      force = Math.max(force, length(history.some(row, "hand_fx", 3)));
      torque = Math.max(torque, length(history.some(row, "hand_tx", 3)));
    }
    const choose = (most, now) => {
      if (!(most > 0)) return now;
      const wanted = (0.33 * page.scene.size) / most;
      return now > wanted || now < 0.3 * wanted ? asperity.roundDown(wanted) : now;
    };
    page.scaleForce = choose(Math.max(force, 0.05), page.scaleForce);
    page.scaleTorque = choose(Math.max(torque, 0.002), page.scaleTorque);
  }

  function drawScale(state) {
    const mark = element("scale");
    mark.hidden = state === null;
    if (state === null) return;
    const { back } = page.scene.axes();
    const eye = add(page.scene.camera.at, times(page.scene.camera.distance, back));
    const pixel = page.scene.metresPerPixel(Math.max(1e-6, length(sub(eye, state.target.centre))));
    const newtons = asperity.roundDown((110 * pixel) / page.scaleForce);
    element("scale-bar").style.width = `${(newtons * page.scaleForce) / pixel}px`;
    const moment = newtons * page.scaleForce / page.scaleTorque;
    element("scale-text").textContent = `${amount(newtons, "N")} \u00b7 ${amount(moment, "N m")}`;
  }

  // --- events
  function addEvent(time, text, bad) {
    const list = element("events"), item = document.createElement("li");
    item.textContent = `${time.toFixed(3)} s  ${text}`;
    if (bad) item.dataset.level = "bad";
    list.prepend(item);
    ++page.events;
    while (list.children.length > 200) list.lastChild.remove();
  }

  function findEvents() {
    const h = page.history, n = page.description.names, seen = page.seen;
    if (seen.row > h.end) Object.assign(seen, { row: h.first, device: -1 });
    const missedBefore = seen.missed ?? 0;
    if (h.missed > missedBefore) addEvent(newestTime(), `${h.missed - missedBefore} ticks were not drawn`, false);
    seen.missed = h.missed;
    for (let row = Math.max(seen.row, h.first); row < h.end; ++row) {
      const time = h.time(row), of = (name) => h.value(row, h.column[name]);
      const fault = of("fault"), device = of("device"), flags = of("flags"), sample = of("sample");
      if (fault !== seen.fault) addEvent(time, fault === 0 ? "gate open" : `gate shut: ${n.fault[fault]}`, fault !== 0);
      if (device !== seen.device && seen.device >= 0) addEvent(time, `device ${n.device[device]}`, n.device[device] === "fault");
      for (let bit = 0; bit < 8; ++bit) {
        if (((flags & ~seen.flags) >> bit) & 1) addEvent(time, `planes: ${n.flags[bit].replaceAll("_", " ")}`, true);
      }
      if (sample !== seen.sample && sample !== 0) addEvent(time, `sample: ${n.sample[sample]}`, true);
      const touches = of("contacts") > 0;
      if (touches && !seen.touches && time - (seen.let ?? -1) > 0.05) addEvent(time, "touches", false);
      if (!touches && seen.touches) seen.let = time;
      Object.assign(seen, { fault, device, flags, sample, touches });
    }
    seen.row = h.end;
  }

  // --- drawing
  function legend(id, entries) {
    const text = entries.map(([label, colour]) => `${colour}|${label}`).join();
    if (element(id).dataset.text === text) return;
    element(id).dataset.text = text;
    element(id).replaceChildren(...entries.map(([label, colour]) => {
      const b = document.createElement("b");
      b.textContent = label;
      if (colour) b.style.color = `var(${colour})`;
      return b;
    }));
  }

  function drawPlots() {
    const h = page.history, span = range(), cursor = shownTime();
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
  }

  function describe(state) {
    const chip = element("state"), names = page.description.names;
    if (page.description.mode === "replay") {
      chip.textContent = "recording";
    } else if (page.over) {
      chip.textContent = "session over";
      delete chip.dataset.level;
    } else if (page.trouble) {
      chip.textContent = "no connection";
      chip.dataset.level = "bad";
    } else if (state !== null) {
      const fault = page.history.value(page.history.end - 1, page.history.column.fault);
      chip.textContent = fault !== 0 ? `gate shut: ${names.fault[fault]}` : page.paused ? "paused" : "live";
      chip.dataset.level = fault !== 0 ? "bad" : page.paused ? "" : "good";
    }
    if (state === null) return;
    const of = (name) => page.history.value(state.row, page.history.column[name]);
    element("readout").textContent = `force ${amount(length(state.hand.force), "N")}   torque ${amount(length(state.hand.torque), "N m")}` +
      `   depth ${amount(of("depth"), "m")}   ${of("contacts")} contacts`;
  }

  function draw(now) {
    requestAnimationFrame(draw);
    const scene = page.scene;
    if (page.turning && scene !== null) { scene.camera.yaw += 0.006; page.changed = true; }
    if (!page.changed && !(scene !== null && scene.asked)) return;
    page.changed = false;
    ++page.frames;
    let state = null;
    if (page.history !== null && page.history.size > 0) {
      state = stateAt(page.at === null ? page.history.end - 1 : page.history.rowAt(page.at));
      page.state = state;
      if (now - page.lastPlots > 90 || page.dirty) {
        page.lastPlots = now;
        page.dirty = false;
        findEvents();
        drawPlots();
        describe(state);
        if (scene !== null) chooseScale(range());
        state.scale = { force: page.scaleForce, torque: page.scaleTorque };
        drawTime();
      }
    }
    if (scene === null) return;
    scene.asked = false;
    if (state !== null) scene.bodies[0].pose = [...state.probe.p, ...state.probe.q];
    scene.bodies.forEach((b, i) => { b.shown = b.probe ? page.shown.probe : page.shown[`body${i}`] ?? page.shown.bodies; });
    scene.draw(state);
    drawScale(state);
  }

  function drawTime() {
    const h = page.history, first = h.time(h.first), last = newestTime();
    const slider = element("time");
    if (document.activeElement !== slider || page.at === null) {
      slider.value = page.at === null ? slider.max : String(Math.round((Number(slider.max) * (page.at - first)) / Math.max(1e-9, last - first)));
    }
    const text = `${shownTime().toFixed(3)} s`;
    element("now").value = text;
    slider.setAttribute("aria-valuetext", text);
    element("hold").setAttribute("aria-pressed", String(page.at !== null));
    element("hold").textContent = page.description.mode === "replay" ? (page.playing ? "Stop" : "Play") : page.at === null ? "Hold" : "Follow";
    for (const [id, pressed] of [["pause", page.paused]]) element(id).setAttribute("aria-pressed", String(pressed));
    element("pause").textContent = page.paused ? "Resume" : "Pause";
  }

  // --- files for people
  function save(name, blob) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  asperity.csvOf = (span) => {
    const h = page.history, columns = page.description.columns;
    const lines = [["time_s", ...columns].join()];
    if (h.size > 0) {
      for (let row = h.rowAt(span.from); row < h.end && h.time(row) <= span.to; ++row) {
        lines.push([h.time(row), ...h.some(row, columns[0], columns.length)].join());
      }
    }
    return lines.join("\n") + "\n";
  };

  function savePicture() {
    page.scene.draw(page.state ?? null);
    page.scene.canvas.toBlob((blob) => save("asperity.png", blob));
  }

  // --- switches
  function setTheme(dark) {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    element("theme").textContent = dark ? "Light" : "Dark";
    if (page.scene !== null) page.scene.dark = dark;
    page.changed = page.dirty = true;
  }

  function listen() {
    const click = (id, act) => element(id).addEventListener("click", act);
    const redraw = () => { page.changed = page.dirty = true; };
    click("theme", () => setTheme(document.documentElement.dataset.theme !== "dark"));
    element("cameras").addEventListener("click", (e) => {
      const from = e.target.dataset.from;
      if (from && page.scene !== null) page.scene.lookFrom(from, page.state ? page.state.probe.centre : null);
    });
    element("colours").addEventListener("change", (e) => { page.scene.paint = e.target.value; redraw(); });
    click("turn", () => {
      page.turning = !page.turning;
      element("turn").setAttribute("aria-pressed", String(page.turning));
      redraw();
    });
    click("picture", savePicture);
    click("table", () => save("asperity.csv", new Blob([asperity.csvOf(range())], { type: "text/csv" })));
    click("hold", () => {
      if (page.description.mode === "replay") {
        page.playing = !page.playing;
        if (page.playing) play();
      } else {
        page.at = page.at === null ? newestTime() : null;
      }
      redraw();
    });
    element("time").addEventListener("input", (e) => {
      const h = page.history, share = Number(e.target.value) / Number(e.target.max);
      page.playing = false;
      page.at = share >= 1 && page.description.mode === "live" ? null : h.time(h.first) + share * (newestTime() - h.time(h.first));
      redraw();
    });
    element("span").addEventListener("change", redraw);
    click("pause", () => asperity.tell(page.paused ? "resume" : "pause"));
    click("step", () => asperity.tell("step=1"));
    element("speed").addEventListener("change", (e) => asperity.tell(`speed=${e.target.value}`));
    new ResizeObserver(redraw).observe(element("scene"));
    new ResizeObserver(redraw).observe(element("force"));
  }

  function play() {
    let before = performance.now();
    const h = page.history;
    if (page.at === null || page.at >= newestTime()) page.at = h.time(h.first);
    const go = (now) => {
      if (!page.playing) return;
      page.at += (now - before) / 1000;
      before = now;
      if (page.at >= newestTime()) { page.at = newestTime(); page.playing = false; page.dirty = true; }
      page.changed = true;
      requestAnimationFrame(go);
    };
    requestAnimationFrame(go);
  }

  function listParts(description) {
    const boxes = description.mode === "model" ? [] : parts.filter(([name]) => name !== "bodies" || description.bodies.length <= 2);
    if (description.bodies.length > 2) description.bodies.forEach((b, i) => { if (i > 0) { boxes.push([`body${i}`, b.name]); page.shown[`body${i}`] = true; } });
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
  }

  function listFacts(description) {
    const table = element("facts"), rows = [["model", "shown", "coarse", "pieces", "texture", "error (rms, most)"]];
    for (const b of description.bodies) {
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
  }

  function trouble(text) {
    element("trouble").textContent = text;
    element("trouble").hidden = text === "";
  }

  async function open() {
    const description = await asperity.loadScene();
    page.description = description;
    document.body.dataset.mode = description.mode;
    element("title").textContent = description.title;
    document.title = `${description.title} \u00b7 asperity`;
    if (description.mode !== "model") description.bodies[0].probe = true;
    element("state").textContent = description.mode === "model" ? "model" : "opening";
    for (const control of element("session").querySelectorAll("button, select")) {
      control.disabled = !description.virtual_clock;
      if (control.disabled) control.title = "A session on the real clock does not wait for anybody";
    }
    listParts(description);
    listFacts(description);
    try {
      page.scene = new asperity.Scene(element("scene"), description);
    } catch (why) {
      trouble(why.message);
    }
    if (description.leads && page.scene !== null) {
      page.scene.lead = new asperity.Lead(page.scene, () => page.state ?? null);
      element("hint").hidden = false;
      element("scene").setAttribute("aria-label", element("scene").getAttribute("aria-label") + " " + element("hint").textContent);
    }
    listen();
    setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
    if (description.mode === "model") {
      page.turning = !matchMedia("(prefers-reduced-motion: reduce)").matches;
      element("turn").setAttribute("aria-pressed", String(page.turning));
    } else {
      page.history = new asperity.History(description.columns, description.mode === "replay" ? Math.max(1, description.rows) : 65536);
    }
    if (page.scene !== null) {
      page.scene.paint = "clay";
      await Promise.all(description.bodies.map(async (b, i) => { page.scene.addMesh(i, await asperity.loadMesh(i)); page.changed = true; }));
      page.scene.lookFrom("corner");
    }
    page.ready = performance.now();
    requestAnimationFrame(draw);
    if (description.mode === "replay") {
      page.history.add(await asperity.loadRows(), 0, description.rows);
      page.at = page.history.size > 0 ? page.history.time(page.history.first) : null;
      page.changed = page.dirty = true;
      if (page.scene !== null) { scenePoses(); page.scene.lookFrom("corner"); }
    }
    if (description.mode === "live") {
      asperity.follow(page.history, (frame) => {
        page.trouble = false;
        trouble("");
        Object.assign(page, { paused: frame.paused, over: frame.over, speed: frame.speed });
        page.contacts = contactsOf(frame.contacts);
        placeBodies(frame.poses);
        page.changed = true;
        if (frame.rows === 0) page.dirty = true;
      }, (why) => {
        if (page.over) return;
        page.trouble = true;
        page.changed = page.dirty = true;
        if (page.history.size === 0) trouble(`The session does not answer (${why.message}).`);
      });
    }
  }

  function scenePoses() {
    const first = pose(page.history.first, "probe");
    page.scene.bodies[0].pose = [...first.p, ...first.q];
  }

  function contactsOf(list) {
    const out = [];
    for (let i = 0; i + 7 < list.length; i += 8) {
      out.push({ p: Array.from(list.slice(i, i + 3)), n: Array.from(list.slice(i + 3, i + 6)), depth: list[i + 6], spread: list[i + 7] });
    }
    return out;
  }

  function placeBodies(poses) {
    if (page.scene === null) return;
    for (let i = 0; i + 6 < poses.length; i += 7) {
      const body = page.scene.bodies[1 + i / 7];
      if (body) body.pose = Array.from(poses.slice(i, i + 7));
    }
  }

  open().catch((why) => trouble(`This page could not be opened: ${why.message}`));
})();
