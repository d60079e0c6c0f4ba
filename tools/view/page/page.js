// The page itself: what its data mean, its switches, and what is drawn when.
"use strict";
(() => {
  const { add, sub, times, length, turn } = asperity.vectors;
  const element = (id) => document.getElementById(id);
  const amount = asperity.amount;
  const parts = [["probe", "Probe"], ["bodies", "Fixed bodies"], ["hand", "Hand"], ["coupling", "Coupling"],
                 ["contacts", "Contact points"], ["map", "Relief at the contact"], ["planes", "Support planes"], ["force", "Force on the hand"],
                 ["torque", "Torque on the hand"], ["probe_force", "Force on the probe"]];
  const page = {
    description: null, scene: null, histories: [], live: null, spectrogram: new asperity.Spectrogram(),
    shown: Object.fromEntries(parts.map(([name]) => [name, name !== "probe_force"])),
    at: null,        // time that is shown; null: the newest
    scaleForce: 1, scaleTorque: 1, contacts: [], seen: [asperity.nothingSeen(), asperity.nothingSeen()],
    get history() { return this.histories[0] ?? null; },
    paused: false, over: false, speed: 1, events: 0, turning: false, changed: true, lastPlots: 0, frames: 0,
  };
  asperity.page = page;

  // --- what is shown at a time
  const filled = () => page.histories.filter((h) => h.size > 0);
  const newestTime = () => Math.max(0, ...filled().map((h) => h.time(h.end - 1)));
  const oldestTime = () => (filled().length > 0 ? Math.min(...filled().map((h) => h.time(h.first))) : 0);
  const compares = () => page.histories.length > 1;
  const shownTime = () => (page.at === null ? newestTime() : page.at);

  function range() {
    const span = Number(element("span").value), oldest = oldestTime();
    if (span === 0) return { from: oldest, to: newestTime() };
    const to = page.at === null ? newestTime() : Math.min(newestTime(), page.at + span / 2);
    return { from: Math.max(oldest, to - span), to: Math.max(to, Math.min(newestTime(), oldest + span)) };
  }

  function pose(history, row, name) {
    const v = Array.from(history.some(row, `${name}_x`, 7));
    return { p: v.slice(0, 3), q: v.slice(3) };
  }

  // One row of a history as the scene draws it. Wrenches are newtons in world axes.
  function handAt(history, row) {
    const c = page.description.bodies[0].centre_of_mass;
    const probe = pose(history, row, "probe"), target = pose(history, row, "target");
    const centre = (at) => add(at.p, turn(at.q, c));
    const vector = (name) => Array.from(history.some(row, name, 3));
    const toWorld = (v) => turn(page.description.device_axes, v);
    return {
      row, probe: { ...probe, centre: centre(probe) }, target: { ...target, centre: centre(target) },
      hand: { force: toWorld(vector("hand_fx")), torque: toWorld(vector("hand_tx")) },
      contact: { force: vector("contact_fx"), torque: vector("contact_tx") },
    };
  }

  // Everything that the scene draws at the time that is shown. A recording that does not run then stays where it was.
  function stateNow() {
    const rowOf = (h) => (page.at === null ? h.end - 1 : h.rowAt(page.at));
    const hands = filled().map((h, i) => ({ ...handAt(h, rowOf(h)), ...(compares() ? compared[i] : {}) }));
    return {
      ...hands[0], hands, scale: { force: page.scaleForce, torque: page.scaleTorque }, shown: page.shown,
      contacts: page.at === null ? page.contacts : [],
    };
  }

  // Of two recordings: the colours of their hands and probes.
  const compared = [{ name: "_a", colour: { light: [0.60, 0.26, 0], dark: [1, 0.69, 0.44] } },
                    { name: "_b", colour: { light: [0.35, 0.21, 0.69], dark: [0.76, 0.66, 1] } }];

  // Metres of an arrow for a newton: so that the largest force of the last seconds is a third of the scene. Steps of two
  // and five, so that arrows do not breathe with the force.
  function chooseScale(span) {
    let force = 0, torque = 0;
    for (const history of filled()) {
      for (let row = history.rowAt(span.from); row < history.end && history.time(row) <= span.to; row += 7) {
        force = Math.max(force, length(history.some(row, "hand_fx", 3)));
        torque = Math.max(torque, length(history.some(row, "hand_tx", 3)));
      }
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

  // --- drawing
  function describe(state) {
    const chip = element("state"), names = page.description.names;
    if (page.description.mode === "replay") {
      chip.textContent = compares() ? "two recordings" : "recording";
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
    if (compares()) { asperity.compare.describe(page, shownTime()); return; }
    const of = (name) => page.history.value(state.row, page.history.column[name]);
    element("readout").textContent = `force ${amount(length(state.hand.force), "N")}   torque ${amount(length(state.hand.torque), "N m")}` +
      `   depth ${amount(of("depth"), "m")}   ${of("contacts")} contacts`;
  }

  function draw(now) {
    requestAnimationFrame(draw);
    const scene = page.scene;
    const passed = Math.min(100, now - (page.before ?? now));
    page.before = now;
    if (page.turning && scene !== null) { scene.camera.yaw += 0.00036 * passed; page.changed = true; }
    if (!page.changed && !(scene !== null && scene.asked)) return;
    page.changed = false;
    ++page.frames;
    let state = null;
    if (page.history !== null && page.history.size > 0) {
      state = stateNow();
      page.state = state;
      if (now - page.lastPlots > 90 || page.dirty) {
        page.lastPlots = now;
        page.dirty = false;
        asperity.findEvents(page);
        (compares() ? asperity.compare.draw : asperity.drawPanels)(page, range(), shownTime());
        describe(state);
        if (scene !== null) chooseScale(range());
        state.scale = { force: page.scaleForce, torque: page.scaleTorque };
        drawTime();
        if (scene !== null) asperity.showContact(page);
      }
    }
    if (scene === null) return;
    scene.asked = false;
    if (state !== null) state.hands.forEach((h, i) => { scene.bodies[i].pose = [...h.probe.p, ...h.probe.q]; });
    scene.bodies.forEach((b, i) => { b.shown = page.shown[`body${i}`] ?? (b.probe ? page.shown.probe : page.shown.bodies); });
    scene.draw(state);
    drawScale(state);
  }

  function drawTime() {
    const first = oldestTime(), last = newestTime();
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

  function savePicture() {
    page.scene.draw(page.state ?? null);
    page.scene.canvas.toBlob((blob) => asperity.save("asperity.png", blob));
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
    element("colours").addEventListener("change", (e) => { page.scene.paint = e.target.value; asperity.showValues(page); redraw(); });
    element("surface").addEventListener("change", (e) => { page.scene.surface = e.target.value; redraw(); });
    click("turn", () => {
      page.turning = !page.turning;
      element("turn").setAttribute("aria-pressed", String(page.turning));
      redraw();
    });
    click("picture", savePicture);
    click("table", () => asperity.save("asperity.csv", new Blob([asperity.csvOf(range())], { type: "text/csv" })));
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
      const share = Number(e.target.value) / Number(e.target.max);
      page.playing = false;
      page.at = share >= 1 && page.description.mode === "live" ? null : oldestTime() + share * (newestTime() - oldestTime());
      redraw();
    });
    element("span").addEventListener("change", redraw);
    element("component").addEventListener("change", redraw);
    click("pause", () => asperity.tell(page.paused ? "resume" : "pause"));
    click("step", () => asperity.tell("step=1"));
    element("speed").addEventListener("change", (e) => asperity.tell(`speed=${e.target.value}`));
    new ResizeObserver(redraw).observe(element("scene"));
    new ResizeObserver(redraw).observe(element("force"));
  }

  function play() {
    let before = performance.now();
    if (page.at === null || page.at >= newestTime()) page.at = oldestTime();
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

  function partsOf(description, hands) {
    if (description.mode === "model") return [];
    const each = [...description.bodies.keys()].filter((i) => (i < hands ? hands > 1 : description.bodies.length - hands > 1));
    const boxes = parts.filter(([name]) => name !== "map" || description.mode === "live").filter(([name]) => (name === "probe" ? hands === 1 : name !== "bodies" || description.bodies.length - hands === 1));
    for (const i of each) {
      page.shown[`body${i}`] = true;
      boxes.push([`body${i}`, i < hands ? `Probe of ${"AB"[i]}` : description.bodies[i].name]);
    }
    return boxes;
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
    if (description.mode === "gallery") {
      element("theme").addEventListener("click", () => setTheme(document.documentElement.dataset.theme !== "dark"));
      setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
      asperity.openGallery(description);
      return;
    }
    const hands = description.mode === "model" ? 0 : Math.max(1, description.recordings.length);
    for (let i = 0; i < hands; ++i) description.bodies[i].probe = true;
    element("state").textContent = description.mode === "model" ? "model" : "opening";
    for (const control of element("session").querySelectorAll("button, select")) {
      control.disabled = !description.virtual_clock;
      if (control.disabled) control.title = "A session on the real clock does not wait for anybody";
    }
    asperity.listParts(page, partsOf(description, hands));
    asperity.listFacts(description);
    asperity.offerErrors(description);
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
      const sizes = description.mode === "replay" ? description.recordings.map((r) => r.rows) : [65536];
      page.histories = sizes.map((rows) => new asperity.History(description.columns, rows));
    }
    if (page.scene !== null) {
      page.scene.paint = "clay";
      const meshes = [...new Set(description.bodies.map((b) => b.mesh))];
      await Promise.all(meshes.map(async (i) => { page.scene.addMesh(i, await asperity.loadMesh(i)); page.changed = true; }));
      page.scene.lookFrom("corner");
    }
    page.ready = performance.now();
    requestAnimationFrame(draw);
    if (description.mode === "replay") {
      await Promise.all(page.histories.map(async (h, i) => h.add(await asperity.loadRows(i), 0, description.recordings[i].rows)));
      page.at = oldestTime();
      if (compares()) asperity.compare.open(page);
      page.changed = page.dirty = true;
      if (page.scene !== null) { scenePoses(); page.scene.lookFrom("corner"); }
    }
    if (description.mode === "live") {
      asperity.follow(page.history, (frame) => {
        page.trouble = false;
        trouble("");
        Object.assign(page, { paused: frame.paused, over: frame.over, speed: frame.speed });
        page.contacts = contactsOf(frame.contacts);
        page.contactProbe = frame.probe;
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

  // Where the probes begin, and of two the second one lets the first one through.
  function scenePoses() {
    page.histories.forEach((h, i) => {
      const first = pose(h, h.first, "probe"), body = page.scene.bodies[i];
      body.pose = [...first.p, ...first.q];
      if (compares()) Object.assign(body, i === 0 ? { clay: [0.62, 0.40, 0.20] } : { clay: [0.42, 0.33, 0.66], alpha: 0.55 });
    });
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
