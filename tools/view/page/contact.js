// The relief around the deepest contact, seen along its normal, coloured by how near the two surfaces are.
"use strict";
(() => {
  const { add, sub, times, dot, cross, length, unit, turn } = asperity.vectors;
  const element = (id) => document.getElementById(id);
  const cells = 50;
  const nearM = 1e-4;  // what comes no nearer has no map

  const intoBody = (pose, place) => turn([-pose[3], -pose[4], -pose[5], pose[6]], sub(place, pose.slice(0, 3)));
  const wayIntoBody = (pose, way) => turn([-pose[3], -pose[4], -pose[5], pose[6]], way);

  // A ball around the points of each patch, once for a mesh: most of a body is far from a contact.
  function ballsOf(mesh) {
    if (mesh.balls) return mesh.balls;
    const size = mesh.high.map((h, k) => h - mesh.low[k]), balls = [];
    let first = 0;
    for (let p = 0; p < mesh.shape.length / 2; ++p) {
      const end = first + (mesh.shape[2 * p] + 1) * (mesh.shape[2 * p + 1] + 1), low = [1, 1, 1], high = [0, 0, 0];
      for (let i = first; i < end; ++i) for (let k = 0; k < 3; ++k) {
        const x = mesh.places[4 * i + k] / 65535;
        low[k] = Math.min(low[k], x);
        high[k] = Math.max(high[k], x);
      }
      const at = (share) => share.map((x, k) => mesh.low[k] + x * size[k]);
      balls.push({ first, end, columns: mesh.shape[2 * p], rows: mesh.shape[2 * p + 1], centre: times(0.5, add(at(low), at(high))),
                   radius: 0.5 * length(sub(at(high), at(low))) });
      first = end;
    }
    return (mesh.balls = balls);
  }

  // Heights of a body's surface over the plane, towards the probe, on a square of `cells` a side and `radius` in each
  // direction: the highest that faces the probe, or of the probe the lowest that faces the body; NaN where there is none.
  function heights(mesh, pose, frame, radius, ofProbe) {
    const out = new Float64Array(cells * cells).fill(NaN), size = mesh.high.map((h, k) => h - mesh.low[k]);
    const centre = intoBody(pose, frame.p), [u, v, up] = [frame.u, frame.v, frame.up].map((way) => wayIntoBody(pose, way));
    const x = [], y = [], h = [];
    for (const ball of ballsOf(mesh)) {
      if (length(sub(ball.centre, centre)) > ball.radius + 1.8 * radius) continue;
      for (let i = ball.first; i < ball.end; ++i) {
        const from = sub([0, 1, 2].map((k) => mesh.low[k] + (mesh.places[4 * i + k] / 65535) * size[k]), centre), at = i - ball.first;
        // In cells; their middles are at whole numbers.
        x[at] = ((dot(from, u) / radius + 1) * cells) / 2 - 0.5;
        y[at] = ((dot(from, v) / radius + 1) * cells) / 2 - 0.5;
        h[at] = dot(from, up);
      }
      const row = ball.columns + 1;
      for (let j = 0; j < ball.rows; ++j) for (let i = 0; i < ball.columns; ++i) {
        const a = j * row + i;
        fill(a, a + 1, a + row);
        if (j + 1 < ball.rows) fill(a + 1, a + row + 1, a + row);
      }
    }
    return out;

    function fill(a, b, c) {
      const twice = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]);
      // u, v and up are right-handed: an outside that faces up runs counter-clockwise.
      if (ofProbe ? twice >= 0 : twice <= 0) return;
      const low = (...n) => Math.max(0, Math.ceil(Math.min(...n))), high = (...n) => Math.min(cells - 1, Math.floor(Math.max(...n)));
      for (let row = low(y[a], y[b], y[c]); row <= high(y[a], y[b], y[c]); ++row) {
        for (let column = low(x[a], x[b], x[c]); column <= high(x[a], x[b], x[c]); ++column) {
          const wb = ((column - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (row - y[a])) / twice;
          const wc = ((x[b] - x[a]) * (row - y[a]) - (column - x[a]) * (y[b] - y[a])) / twice;
          if (wb < 0 || wc < 0 || wb + wc > 1) continue;
          const height = h[a] + wb * (h[b] - h[a]) + wc * (h[c] - h[a]), at = row * cells + column;
          if (Math.abs(height) > radius) continue;
          if (Number.isNaN(out[at]) || (ofProbe ? height < out[at] : height > out[at])) out[at] = height;
        }
      }
    }
  }

  // `contact`: its place and its normal from the probe to the body, world; `right`: what is to the right on the map.
  asperity.contactMap = (body, probe, contact, right, radius) => {
    const up = times(-1, contact.n), u = unit(sub(right, times(dot(right, up), up)));
    const frame = { p: contact.p, up, u, v: cross(up, u) };
    const surface = heights(body.mesh, body.pose, frame, radius, false), above = heights(probe.mesh, probe.pose, frame, radius, true);
    return { cells, frame, surface, clearance: surface.map((s, i) => above[i] - s) };
  };

  const deepestOf = (contacts) => contacts.reduce((most, c) => (most === null || c.depth > most.depth ? c : most), null);

  // The body whose patches come nearest to a place.
  function bodyAt(scene, place) {
    let best = null, least = Infinity;
    for (const b of scene.bodies) {
      if (b.probe || b.drawing === null || !b.shown) continue;
      const at = intoBody(b.pose, place);
      for (const ball of ballsOf(b.drawing.mesh)) {
        const far = Math.max(0, length(sub(ball.centre, at)) - ball.radius);
        if (far < least) { least = far; best = b; }
      }
    }
    return best;
  }

  let last = 0;
  asperity.showContact = (page) => {
    const box = element("contact"), deepest = deepestOf(page.contacts), scene = page.scene;
    const shows = page.at === null && page.shown.map && deepest !== null && deepest.depth > -nearM && page.contactProbe;
    box.hidden = !shows;
    if (!shows || performance.now() - last < 250) return;
    last = performance.now();
    const body = bodyAt(scene, deepest.p), probe = scene.bodies[0];
    if (body === null || probe.drawing === null) return;
    const step = Math.max(body.step_m, probe.step_m, 1e-6), radius = Math.max(0.025 * scene.size, 8 * step);
    const { right } = scene.axes();
    const map = asperity.contactMap({ mesh: body.drawing.mesh, pose: body.pose }, { mesh: probe.drawing.mesh, pose: page.contactProbe },
                                    deepest, Math.abs(dot(right, deepest.n)) < 0.98 ? right : scene.axes().up, radius);
    page.contactMap = { ...map, radius, deepest, body: body.name };
    paint(map, page.contacts, radius, deepest);
    const all = page.contacts.filter((c) => c.depth > 0).length;
    element("contact-text").textContent = `${asperity.amount(2 * radius, "m", 2)} wide; ${all} point${all === 1 ? "" : "s"}, ${deepest.depth > 0 ? "deepest" : "nearest"} ${asperity.amount(Math.abs(deepest.depth), "m", 2)}`;
    element("contact-map").setAttribute("aria-label", `Relief of ${body.name} around the deepest contact. ${element("contact-text").textContent}`);
  };

  // Light from the upper left on the relief; orange where the surfaces overlap, blue where the gap is small.
  function paint(map, contacts, radius, deepest) {
    const canvas = element("contact-map"), g = canvas.getContext("2d"), side = canvas.width, each = side / cells;
    const near = Math.max(5e-5, 2 * deepest.depth), cell = (2 * radius) / cells;
    g.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--scene");
    g.fillRect(0, 0, side, side);
    const at = (row, column) => map.surface[Math.max(0, Math.min(cells - 1, row)) * cells + Math.max(0, Math.min(cells - 1, column))];
    for (let row = 0; row < cells; ++row) for (let column = 0; column < cells; ++column) {
      if (Number.isNaN(at(row, column))) continue;
      const sx = (at(row, column + 1) - at(row, column - 1)) / (2 * cell) || 0, sy = (at(row + 1, column) - at(row - 1, column)) / (2 * cell) || 0;
      const light = 0.35 + 0.6 * Math.max(0, (0.5 * sx - 0.5 * sy + 0.7) / Math.hypot(sx, sy, 1));
      const gap = map.clearance[row * cells + column], share = Number.isNaN(gap) ? 0 : Math.max(0, 1 - Math.abs(gap) / near);
      const full = gap < 0 ? [235, 95, 20] : [70, 130, 220], by = gap < 0 ? Math.max(0.5, Math.min(1, -gap / near + 0.5)) : share;
      g.fillStyle = `rgb(${[190, 190, 185].map((c, k) => Math.round(light * (c + by * (full[k] - c)))).join()})`;
      // Rows run upwards.
      g.fillRect(Math.floor(column * each), Math.floor((cells - 1 - row) * each), Math.ceil(each), Math.ceil(each));
    }
    for (const c of contacts) {
      const from = sub(c.p, map.frame.p), place = [dot(from, map.frame.u), dot(from, map.frame.v)].map((x) => x / radius);
      if (Math.max(...place.map(Math.abs)) > 1 || Math.abs(dot(from, map.frame.up)) > radius) continue;
      g.beginPath();
      g.arc(((place[0] + 1) * side) / 2, ((1 - place[1]) * side) / 2, c.depth > 0 ? 4 : 2.5, 0, 2 * Math.PI);
      const heat = Math.max(0, Math.min(1, c.depth / Math.max(1e-9, deepest.depth)));
      g.fillStyle = c.depth > 0 ? `rgb(${[255, Math.round(210 - 150 * heat), Math.round(80 - 60 * heat)].join()})` : "rgb(60, 110, 200)";
      g.fill();
      g.strokeStyle = "#000";
      g.lineWidth = 1;
      g.stroke();
    }
  }
})();
