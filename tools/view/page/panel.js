// A device on a page: what it measures, how its loop keeps time, and a force while a button is held.
"use strict";
(() => {
  const element = (id) => document.getElementById(id);
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const token = new URLSearchParams(location.hash.slice(1)).get("token") || "";
  const headers = { "X-Asperity-Token": token, "X-Asperity": "1" };
  const kept = 4000; // periods
  const panel = { held: null, now: null, periods: [], seen: 0, beatEvery: 25, beats: 0, described: null };
  asperity.panel = panel;

  async function ask(path, options = {}) {
    const answer = await fetch(path, { headers, ...options });
    const text = await answer.text();
    if (!answer.ok) throw Object.assign(new Error(text.trim()), { code: answer.status });
    return text === "" ? {} : JSON.parse(text);
  }
  const tell = (what, options = {}) => ask(`do?${what}`, { method: "POST", ...options });

  // The force test. Nothing is kept from one press to the next: each has a name of its own, which ends with it.
  function say(text, bad = false) {
    element("push-state").textContent = text;
    element("push-state").style.color = bad ? "var(--late)" : "";
  }
  const attended = () => document.visibilityState === "visible" && document.hasFocus();

  async function press() {
    if (panel.held !== null || !attended()) return;
    const held = { name: null, beats: 0, under: false };
    panel.held = held;
    element("push").setAttribute("aria-pressed", "true");
    say("asking");
    try {
      const answer = await tell(`press=${element("axis").value[1]},${element("axis").value[0] === "-" ? "-" : ""}${element("newtons").value}`);
      held.name = answer.press;
      if (panel.held !== held) tell(`release=${held.name}`).catch(() => {}); // let go meanwhile
      else panel.beat();
    } catch (why) {
      end(why.message, true, held);
    }
  }

  function end(text = "released", bad = false, which = panel.held) {
    if (which === null || panel.held !== which) return;
    panel.held = null;
    element("push").setAttribute("aria-pressed", "false");
    if (which.name !== null) tell(`release=${which.name}`, { keepalive: true }).catch(() => {});
    say(text, bad);
  }
  panel.end = end;

  // One beat at a time: what is on its way may not pile up behind a server that hangs, and arrive together.
  panel.beat = () => {
    const held = panel.held;
    if (held === null || held.name === null || held.under) return;
    if (!attended()) return end("the page is not in front", true);
    held.under = true;
    tell(`beat=${held.name},${++held.beats}`).then(() => {
      ++panel.beats;
      if (panel.held === held) say("held");
    }, (why) => end(why.message, true, held)).finally(() => { held.under = false; });
  };

  function listen() {
    const push = element("push");
    let key = null;
    push.addEventListener("pointerdown", (e) => {
      if (e.button !== 0 || !e.isPrimary) return;
      push.focus();
      press();
    });
    for (const name of ["pointerup", "pointercancel", "pointerleave", "lostpointercapture"]) push.addEventListener(name, () => end());
    push.addEventListener("contextmenu", (e) => { e.preventDefault(); end(); });
    push.addEventListener("keydown", (e) => {
      if (e.key !== " " && e.key !== "Enter") { end(); return; }
      e.preventDefault();
      if (e.repeat || key !== null) return;
      key = e.key;
      press();
    });
    window.addEventListener("keyup", (e) => { if (e.key === key) { key = null; end(); } });
    window.addEventListener("pointerup", () => { if (key === null) end(); });
    push.addEventListener("blur", () => { key = null; end("the button lost the focus", true); });
    window.addEventListener("blur", () => { key = null; end("the page lost the focus", true); });
    window.addEventListener("pagehide", () => end());
    document.addEventListener("visibilitychange", () => { if (document.visibilityState !== "visible") end("the page is hidden", true); });
    for (const id of ["axis", "newtons"]) element(id).addEventListener("change", () => end());
    setInterval(() => panel.beat(), panel.beatEvery);
  }

  // What is shown.
  const fixed = (v, digits) => (v < 0 ? "" : " ") + v.toFixed(digits);
  const rows = (id, list) => {
    const body = element(id);
    while (body.rows.length < list.length) {
      const row = body.insertRow(), head = document.createElement("th");
      head.scope = "row";
      row.append(head);
      row.insertCell();
    }
    list.forEach(([name, text], i) => {
      if (body.rows[i].cells[0].textContent !== name) body.rows[i].cells[0].textContent = name;
      if (body.rows[i].cells[1].textContent !== text) body.rows[i].cells[1].textContent = text;
    });
  };
  const bits = { position: 1, rotation: 2, buttons: 16, gripper: 32 };

  function describe(d) {
    panel.described = d;
    const l = d.limits;
    element("title").textContent = d.device;
    document.title = `asperity: ${d.device}`;
    const box = (v) => v.map((x) => (1e3 * x).toFixed(0)).join(", ");
    rows("limits", [["driver", l.maturity], ["measures", l.sensed_axes.join(" ")], ["pushes", l.actuated_axes.join(" ") || "nothing"],
      ["force", `${asperity.short(l.peak_force)} N peak, ${asperity.short(l.continuous_force)} N continuous`],
      ["torque", `${asperity.short(l.peak_torque)} N m peak, ${asperity.short(l.continuous_torque)} N m continuous`],
      ["workspace", `${box(l.workspace.low)} to ${box(l.workspace.high)} mm`], ["rate", `${asperity.short(l.nominal_rate_hz)} Hz`],
      ["watchdog", l.device_side_watchdog ? "of the device's own" : "none in the device"]]);
    element("why-not").hidden = d.force.offered;
    element("test").hidden = !d.force.offered;
    if (!d.force.offered) { element("why-not").textContent = `Not offered: ${d.force.why_not}.`; return; }
    for (const a of l.actuated_axes.filter((x) => "xyz".includes(x))) {
      for (const sign of ["+", "-"]) element("axis").add(new Option(`${sign}${a}`, `${sign}${a}`));
    }
    for (const share of [0.25, 0.5, 0.75, 1]) {
      const n = Math.floor(1e4 * share * d.force.most) / 1e4;
      element("newtons").add(new Option(`${asperity.short(n)} N`, String(n)));
    }
    listen();
  }

  function event(text, bad) {
    const item = document.createElement("li");
    item.textContent = `${(panel.now.time - panel.began).toFixed(2)} s  ${text}`;
    if (bad) item.dataset.level = "bad";
    element("events").prepend(item);
    while (element("events").children.length > 200) element("events").lastChild.remove();
  }

  function find(before, now) {
    if (before === null) { event(`device ${now.device}`, now.device === "fault"); }
    if (before !== null && before.device !== now.device && !(/armed|active/.test(before.device) && /armed|active/.test(now.device))) event(`device ${now.device}`, now.device === "fault");
    if (before?.fault !== now.fault && now.fault !== "none") event(`gate shut: ${now.fault}`, true);
    if (before?.sample !== now.sample && now.sample !== "accepted") event(`sample: ${now.sample}`, true);
    if (before !== null && (before.press !== now.press || before.press_end !== now.press_end) && now.press > 0) event(`force test: ${now.press_end}`, !/held|released/.test(now.press_end));
    if (before !== null && before.lapses < now.lapses) event(`${now.lapses - before.lapses} ticks came after the last command had expired`, true);
  }

  function show(now) {
    const of = (bit) => (now.measured & bit) !== 0;
    element("position").textContent = of(bits.position) ? now.position.map((x) => fixed(1e3 * x, 2)).join(" ") + " mm" : "not measured";
    element("rotation").textContent = of(bits.rotation) ? now.rotation.map((x) => fixed(x, 4)).join(" ") : "not measured";
    const pressed = [...Array(32).keys()].filter((i) => (now.buttons >>> i) & 1).map((i) => i + 1);
    element("buttons").textContent = of(bits.buttons) ? (pressed.length === 0 ? "none pressed" : `${pressed.join(" ")} pressed`) : "not measured";
    element("gripper-row").hidden = !of(bits.gripper);
    element("gripper").textContent = `${fixed(1e3 * now.gripper, 1)} mm`;
    const open = now.fault === "none", force = Math.hypot(...now.force);
    element("state").textContent = open ? `gate open, device ${now.device}` : `gate shut: ${now.fault}`;
    element("state").dataset.level = open ? "good" : "bad";
    element("put-out").textContent = `${force.toFixed(3)} N`;
    if (panel.held === null && !open) say("gate shut: start the command anew", true);
    element("push").disabled = !open;
    rows("counts", [["ticks", String(now.ticks)], ["periods left out", String(now.lost_periods)], ["longest gap", asperity.amount(now.longest_gap, "s")],
      ["late or bad samples", String(now.rejected)], ["reads without news", String(now.repeated)], ["lost on the way", String(now.lost)]]);
    const p = panel.periods, n = p.length;
    if (n < 2) return;
    const history = { column: { took: 0 }, size: n, rowAt: (t) => (t <= 0 ? 0 : n - 1), value: (row) => 1e-9 * p[row] };
    const told = asperity.drawTicks(element("periods"), history, { from: 0, to: 1 }, 2 * panel.described.period);
    let sum = 0, squares = 0;
    for (const x of p) { sum += 1e-9 * x; squares += (1e-9 * x) ** 2; }
    const mean = sum / n, jitter = Math.sqrt(Math.max(0, squares / n - mean * mean));
    panel.rate = 1 / mean;
    panel.jitter = jitter;
    element("readout").textContent = `${(1 / mean).toFixed(1)} Hz, jitter ${asperity.amount(jitter, "s")}`;
    element("period-legend").textContent = told === null ? "" : `p50 ${asperity.amount(told.p50, "s")}  p99 ${asperity.amount(told.p99, "s")}  over two periods ${told.late}`;
  }

  // The workspace from a corner; lengths in it are as long as they are along every axis.
  function draw(now) {
    const canvas = element("pose"), ratio = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    const g = canvas.getContext("2d"), { low, high } = panel.described.limits.workspace;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    const size = Math.max(1e-3, Math.hypot(...high.map((x, i) => x - low[i]))), middle = high.map((x, i) => 0.5 * (x + low[i]));
    const scale = (0.8 * Math.min(width, height)) / size, c = Math.cos(Math.PI / 6), s = Math.sin(Math.PI / 6);
    const at = (v) => {
      const [x, y, z] = v.map((e, i) => e - middle[i]);
      return [width / 2 + scale * c * (y - x), height / 2 + scale * (s * (x + y) * 0.8 - z * 0.9)];
    };
    const line = (a, b, colour, wide = 1) => {
      g.strokeStyle = colour;
      g.lineWidth = wide;
      g.beginPath();
      g.moveTo(...at(a));
      g.lineTo(...at(b));
      g.stroke();
    };
    for (let axis = 0; axis < 3; ++axis) {
      for (let k = 0; k < 4; ++k) {
        const from = [0, 1, 2].map((i) => (i === axis ? low[i] : (k >> ((i - axis + 2) % 3)) & 1 ? high[i] : low[i]));
        line(from, from.map((x, i) => (i === axis ? high[i] : x)), css("--line"));
      }
    }
    const p = now.position, [qx, qy, qz, qw] = now.rotation, arm = 0.16 * size;
    const turn = (v) => {
      const t = [2 * (qy * v[2] - qz * v[1]), 2 * (qz * v[0] - qx * v[2]), 2 * (qx * v[1] - qy * v[0])];
      return [v[0] + qw * t[0] + qy * t[2] - qz * t[1], v[1] + qw * t[1] + qz * t[0] - qx * t[2], v[2] + qw * t[2] + qx * t[1] - qy * t[0]];
    };
    g.font = "12px system-ui, sans-serif";
    ["--x", "--y", "--z"].forEach((colour, i) => {
      const unit = [0, 0, 0];
      unit[i] = arm;
      const corner = low.map((x, k) => x + unit[k]);
      line(low, corner, css(colour), 1.5);
      g.fillStyle = css(colour);
      g.fillText("xyz"[i], at(corner)[0] + 3, at(corner)[1] - 3);
      line(p, turn(unit).map((x, k) => x + p[k]), css(colour), 2.5);
    });
    line(p, [p[0], p[1], low[2]], css("--soft"));
    const force = Math.hypot(...now.force), most = panel.described.force.most;
    if (force > 0 && most > 0) line(p, now.force.map((x, i) => p[i] + (2 * arm * x) / most), css("--accent"), 5);
    g.fillStyle = css("--ink");
    g.beginPath();
    g.arc(...at(p), 5, 0, 2 * Math.PI);
    g.fill();
  }

  async function follow() {
    for (;;) {
      try {
        const now = await ask(`panel-state?after=${panel.seen}`);
        panel.seen = now.periods_end;
        panel.periods.push(...now.periods);
        panel.periods.splice(0, Math.max(0, panel.periods.length - kept));
        panel.began ??= now.time;
        const before = panel.now;
        panel.now = now;
        find(before, now);
        show(now);
        draw(now);
      } catch (why) {
        end("the panel does not answer", true);
        element("state").textContent = why.code ? why.message : "no answer";
        element("state").dataset.level = "bad";
        element("push").disabled = true;
        await new Promise((later) => setTimeout(later, 500));
      }
      await new Promise((later) => setTimeout(later, 60));
    }
  }

  function theme(dark) {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    element("theme").textContent = dark ? "Light" : "Dark";
  }
  theme(matchMedia("(prefers-color-scheme: dark)").matches);
  element("theme").addEventListener("click", () => theme(document.documentElement.dataset.theme !== "dark"));
  ask("panel.json").then((d) => { describe(d); follow(); }, (why) => {
    element("state").textContent = why.message || "no answer";
    element("state").dataset.level = "bad";
  });
})();
