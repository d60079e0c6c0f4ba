// The scene in three dimensions: bodies, hand, contacts and arrows, on WebGL 2.
"use strict";
(() => {
  const { add, sub, times, dot, cross, length, unit, turn } = asperity.vectors;
  const { poseMatrix, along, multiply } = asperity.matrices;
  const { make, bodyVertex, bodyFragment, partVertex, partFragment } = asperity.programs;

  class Scene {
    constructor(canvas, description) {
      const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: false });
      if (gl === null) throw new Error("This browser has no WebGL 2: the scene is not drawn, the panels are.");
      this.canvas = canvas;
      this.gl = gl;
      this.body = make(gl, bodyVertex, bodyFragment);
      this.part = make(gl, partVertex, partFragment);
      this.shapes = Object.fromEntries(Object.entries(asperity.shapes).map(([name, data]) => [name, this.buffer(data)]));
      this.bodies = description.bodies.map((b) => ({ ...b, drawing: null, shown: true }));
      this.camera = { at: [0, 0, 0], distance: 1, yaw: -0.9, pitch: 0.5 };
      this.paint = "clay";
      this.surface = "textured";  // or "coarse", or "both"
      this.dark = false;
      this.drawn = { arrows: {} };
      asperity.steer(this);
    }

    buffer(data) {
      const gl = this.gl, vao = gl.createVertexArray();
      gl.bindVertexArray(vao);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      for (const i of [0, 1]) {
        gl.enableVertexAttribArray(i);
        gl.vertexAttribPointer(i, 3, gl.FLOAT, false, 24, 12 * i);
      }
      gl.bindVertexArray(null);
      return { vao, count: data.length / 6 };
    }

    // For all bodies that have this mesh.
    addMesh(i, mesh) {
      const gl = this.gl, vao = gl.createVertexArray();
      gl.bindVertexArray(vao);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, mesh.places, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 4, gl.UNSIGNED_SHORT, true, 8, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, mesh.normals, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 4, gl.BYTE, false, 4, 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
      if (mesh.errors !== null) {
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, mesh.errors, gl.STATIC_DRAW);
        gl.enableVertexAttribArray(2);
        gl.vertexAttribPointer(2, 1, gl.UNSIGNED_SHORT, true, 2, 0);
      }
      gl.bindVertexArray(null);
      const drawing = { vao, count: mesh.indices.length, ...this.coarse(mesh), low: mesh.low, relief: mesh.relief,
                        hasErrors: mesh.errors !== null, mesh,
                        size: mesh.high.map((h, k) => h - mesh.low[k]) };
      for (const b of this.bodies) if (b.mesh === i) b.drawing = drawing;
    }

    // The coarse mesh: flat triangles in the colours of their pieces, and their edges.
    coarse(mesh) {
      const gl = this.gl, count = mesh.triangles.length / 3;
      const size = mesh.high.map((h, k) => h - mesh.low[k]), normals = new Int8Array(12 * count), places = new Float32Array(12 * count);
      const edges = new Map();
      let point = 0;
      for (let t = 0; t < count; ++t) {
        const corner = [0, 1, 2].map((k) => Array.from(mesh.corners.subarray(3 * mesh.triangles[3 * t + k], 3 * mesh.triangles[3 * t + k] + 3)));
        const n = unit(cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]))).map((x) => Math.round(127 * x));
        for (let k = 0; k < 3; ++k) {
          // Shares of the box of the points, in which the program thinks; the relief is none.
          places.set([0, 1, 2].map((i) => (corner[k][i] - mesh.low[i]) / (size[i] || 1)), 12 * t + 4 * k);
          places[12 * t + 4 * k + 3] = -mesh.relief[0] / ((mesh.relief[1] - mesh.relief[0]) || 1);
          normals.set([...n, mesh.normals[4 * point + 3]], 12 * t + 4 * k);
          const [one, other] = [mesh.triangles[3 * t + k], mesh.triangles[3 * t + (k + 1) % 3]];
          edges.set(`${Math.min(one, other)} ${Math.max(one, other)}`, [3 * t + k, 3 * t + (k + 1) % 3]);
        }
        point += (mesh.shape[2 * t] + 1) * (mesh.shape[2 * t + 1] + 1);
      }
      const vao = gl.createVertexArray();
      gl.bindVertexArray(vao);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, places, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 16, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, normals, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 4, gl.BYTE, false, 4, 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array([...edges.values()].flat()), gl.STATIC_DRAW);
      gl.bindVertexArray(null);
      return { coarseVao: vao, coarsePoints: 3 * count, coarseEdges: edges.size };
    }

    // Box of all bodies where they are, in the world.
    box() {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (const b of this.bodies) {
        if (b.drawing === null) continue;
        for (let corner = 0; corner < 8; ++corner) {
          const p = [0, 1, 2].map((k) => b.drawing.low[k] + ((corner >> k) & 1) * b.drawing.size[k]);
          const w = add(b.pose.slice(0, 3), turn(b.pose.slice(3), p));
          for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], w[k]); high[k] = Math.max(high[k], w[k]); }
        }
      }
      return { low, high, size: Math.max(1e-6, length(sub(high, low))) };
    }

    get size() { return this.worldSize ?? (this.worldSize = this.box().size); }

    lookFrom(name, touch = null) {
      const box = this.box();
      this.worldSize = box.size;
      const views = { corner: [-0.9, 0.5], front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2 - 1e-3] };
      [this.camera.yaw, this.camera.pitch] = views[name] ?? [-0.9, 0.25];
      this.camera.at = name === "touch" && touch !== null ? touch : times(0.5, add(box.low, box.high));
      this.camera.distance = (name === "touch" ? 0.6 : 1.7) * box.size;
      this.asked = true;
    }

    rotate(yaw, pitch) {
      this.camera.yaw += yaw;
      this.camera.pitch = Math.max(-1.569, Math.min(1.569, this.camera.pitch + pitch));
      this.asked = true;
    }
    zoom(by) { this.camera.distance = Math.max(0.01 * this.size, Math.min(20 * this.size, by * this.camera.distance)); this.asked = true; }
    pan(x, y) {
      const { right, up } = this.axes();
      const step = this.metresPerPixel();
      this.camera.at = add(this.camera.at, add(times(-step * x, right), times(step * y, up)));
      this.asked = true;
    }
    metresPerPixel(distance = this.camera.distance) {
      return (2 * distance * Math.tan(0.5 * this.fov())) / Math.max(1, this.canvas.clientHeight);
    }
    // What is wide stays in a window that is narrow.
    fov() {
      const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
      return aspect >= 1 ? 0.6 : 2 * Math.atan(Math.tan(0.3) / aspect);
    }

    // Where a place of the world is on the canvas, in pixels, and how many metres one of them is there.
    onCanvas(place) {
      const { right, up, back } = this.axes();
      const from = sub(place, add(this.camera.at, times(this.camera.distance, back)));
      const pixel = this.metresPerPixel(Math.max(1e-6, -dot(from, back)));
      return { x: 0.5 * this.canvas.clientWidth + dot(from, right) / pixel, y: 0.5 * this.canvas.clientHeight - dot(from, up) / pixel, pixel };
    }

    axes() {
      const { yaw, pitch } = this.camera;
      const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
      const right = [-Math.sin(yaw), Math.cos(yaw), 0];
      return { back, right, up: cross(back, right) };
    }

    viewMatrix() {
      const { back, right, up } = this.axes();
      const eye = add(this.camera.at, times(this.camera.distance, back));
      const look = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
                    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
      const near = Math.max(1e-4 * this.size, this.camera.distance - 3 * this.size), far = this.camera.distance + 3 * this.size;
      const f = 1 / Math.tan(0.5 * this.fov()), aspect = this.canvas.width / Math.max(1, this.canvas.height);
      const project = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
      return { eye, matrix: multiply(project, look), key: unit(add(times(0.55, back), add(times(-0.62, right), times(0.75, up)))) };
    }

    // `state`: target {p, q}, hand and contact wrenches with their scale, contacts, which parts are shown.
    draw(state) {
      const gl = this.gl, c = this.canvas;
      const ratio = Math.min(2, window.devicePixelRatio || 1);
      const [w, h] = [Math.round(c.clientWidth * ratio), Math.round(c.clientHeight * ratio)];
      if (c.width !== w || c.height !== h) { c.width = w; c.height = h; }
      gl.viewport(0, 0, w, h);
      gl.clearColor(...(this.dark ? [0.063, 0.075, 0.086] : [0.914, 0.918, 0.902]), 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      const view = this.viewMatrix();
      this.drawBodies(view);
      gl.useProgram(this.part.made);
      gl.uniformMatrix4fv(this.part.at.view, false, view.matrix);
      gl.uniform3fv(this.part.at.key, view.key);
      this.drawn = { arrows: {}, contacts: 0 };
      if (state === null) return;
      this.drawContacts(state);
      for (const s of state.hands) this.drawHand(s, state);
    }

    drawBodies(view) {
      const gl = this.gl, at = this.body.at;
      gl.useProgram(this.body.made);
      gl.uniformMatrix4fv(at.view, false, view.matrix);
      gl.uniform3fv(at.eye, view.eye);
      gl.uniform3fv(at.key, view.key);
      gl.uniform3fv(at.scaleLow, asperity.aboutZero[0]);
      gl.uniform3fv(at.scaleMiddle, asperity.aboutZero[1]);
      gl.uniform3fv(at.scaleHigh, asperity.aboutZero[2]);
      gl.uniform3fv(at.heat, asperity.heatLinear);
      gl.uniform3fv(at.colours, [0.40, 0.58, 0.78, 0.80, 0.58, 0.34, 0.26, 0.52, 0.42, 0.76, 0.46, 0.58,
                                 0.80, 0.76, 0.42, 0.38, 0.36, 0.66, 0.60, 0.80, 0.80, 0.66, 0.32, 0.24]);
      const order = [...this.bodies.keys()].sort((one, other) => (this.bodies[one].alpha ? 1 : 0) - (this.bodies[other].alpha ? 1 : 0));
      order.forEach((i) => {
        const b = this.bodies[i];
        if (b.drawing === null || !b.shown) return;
        gl.uniformMatrix4fv(at.model, false, poseMatrix(b.pose.slice(0, 3), b.pose.slice(3)));
        gl.uniform3fv(at.low, b.drawing.low);
        gl.uniform3fv(at.size, b.drawing.size);
        gl.uniform3fv(at.clay, b.clay ?? (b.probe ? [0.60, 0.47, 0.30] : i % 2 === 1 ? [0.50, 0.53, 0.55] : [0.46, 0.50, 0.44]));
        const [low, high] = b.drawing.relief;
        gl.uniform1f(at.zero, high > low ? -low / (high - low) : 0.5);
        // What is seen through is drawn over what has been drawn before, also where both are at the same place.
        gl.uniform1f(at.alpha, b.alpha ?? 1);
        if (b.alpha) {
          gl.enable(gl.BLEND);
          gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
          gl.enable(gl.POLYGON_OFFSET_FILL);
          gl.polygonOffset(-1, -8);
        }
        const paint = { clay: 0, relief: 1, pieces: 2, error: b.drawing.hasErrors ? 3 : 0 }[this.paint];
        if (this.surface !== "coarse") {
          gl.uniform1i(at.paint, paint);
          gl.bindVertexArray(b.drawing.vao);
          gl.drawElements(gl.TRIANGLES, b.drawing.count, gl.UNSIGNED_INT, 0);
        }
        gl.disable(gl.BLEND);
        if (this.surface !== "textured") this.drawCoarse(b, at, paint);
        gl.disable(gl.POLYGON_OFFSET_FILL);
      });
      gl.bindVertexArray(null);
    }

    // Edges lie in front of the triangles that they are of, and show faintly through the relief.
    drawCoarse(b, at, paint) {
      const gl = this.gl;
      gl.bindVertexArray(b.drawing.coarseVao);
      if (this.surface === "coarse") {
        gl.uniform1i(at.paint, paint === 2 ? 2 : 0);
        gl.enable(gl.POLYGON_OFFSET_FILL);
        gl.polygonOffset(1, 1);
        gl.drawArrays(gl.TRIANGLES, 0, b.drawing.coarsePoints);
        gl.disable(gl.POLYGON_OFFSET_FILL);
      }
      gl.uniform1i(at.paint, 4);
      const lines = (alpha) => { gl.uniform1f(at.alpha, alpha); gl.drawElements(gl.LINES, 2 * b.drawing.coarseEdges, gl.UNSIGNED_INT, 0); };
      if (this.surface === "both") {
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthFunc(gl.GREATER);
        gl.depthMask(false);
        lines(0.12);
        gl.depthMask(true);
        gl.depthFunc(gl.LEQUAL);
        gl.disable(gl.BLEND);
      }
      lines(1);
    }

    shape(name, matrix, tint, shaded = 1) {
      const gl = this.gl, at = this.part.at, of = this.shapes[name];
      gl.uniformMatrix4fv(at.model, false, matrix);
      gl.uniform4fv(at.tint, tint);
      gl.uniform1f(at.shaded, shaded);
      gl.bindVertexArray(of.vao);
      gl.drawArrays(gl.TRIANGLES, 0, of.count);
    }

    // An arrow is as long as its vector times its scale, tip included. What was drawn is kept for whoever measures.
    arrow(name, from, vector, scale, tint, twist) {
      const way = times(scale, vector), long = length(way);
      if (!(long > 1e-4 * this.size)) { this.drawn.arrows[name] = { from, tip: from, length: 0, scale }; return; }
      const thick = 0.007 * this.size, head = Math.min(0.6 * long, 5 * thick);
      const shaft = times(1 - head / long, way);
      this.shape("rod", along(from, shaft, thick), tint);
      this.shape("cone", along(add(from, shaft), times(head / long, way), 2.4 * thick), tint);
      if (twist) this.shape("ring", along(add(from, times(0.5, shaft)), times(3.2 * thick / long, way), 3.2 * thick), tint);
      this.drawn.arrows[name] = { from, tip: add(from, way), length: long, scale };
    }

    // Arrows and the hand are what people look for: they are seen through bodies, faintly.
    throughBodies(paint, hidden) {
      const gl = this.gl;
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthFunc(gl.GREATER);
      gl.depthMask(false);
      paint(hidden);
      gl.depthMask(true);
      gl.depthFunc(gl.LEQUAL);
      paint(1);
      gl.disable(gl.BLEND);
    }

    drawContacts(s) {
      const size = this.size, shown = s.shown;
      if (shown.contacts) {
        this.drawn.contacts = s.contacts.length;
        this.throughBodies((strength) => {
          for (const c of s.contacts) {
            const heat = Math.max(0, Math.min(1, 0.5 + c.depth / 2e-4));
            // A gap is small and blue; what presses is large, the deeper the redder.
            const touches = c.depth > 0;
            const tint = touches ? [0.85, 0.25 + 0.4 * (1 - heat), 0.1, strength] : [0.15, 0.42, 0.75, 0.5 * strength];
            const out = times(-0.0015 * size, c.n);
            this.shape("ball", poseMatrix(c.p, [0, 0, 0, 1], (touches ? 0.006 : 0.003) * size), tint);
            if (shown.planes && touches) {
              const radius = Math.max(0.012 * size, Math.min(0.1 * size, c.spread));
              this.shape("disc", along(add(c.p, out), c.n, radius), [...tint.slice(0, 3), 0.3 * strength]);
              this.shape("rod", along(c.p, times(-0.05 * size, c.n), 0.0014 * size), tint);
            }
          }
        }, 0.15);
      }
    }

    // `s`: one hand with its probe; `all`: what is the same of all hands.
    drawHand(s, all) {
      const size = this.size, shown = all.shown;
      this.throughBodies((strength) => {
        const hand = s.target.centre, probe = s.probe.centre;
        const own = s.colour ? (this.dark ? s.colour.dark : s.colour.light) : null;
        const gold = [...(own ?? (this.dark ? [0.95, 0.85, 0.4] : [0.55, 0.40, 0.0])), strength];
        if (shown.hand) this.shape("ball", poseMatrix(hand, [0, 0, 0, 1], 0.012 * size), gold);
        if (shown.coupling && length(sub(hand, probe)) > 1e-9) {
          this.shape("rod", along(probe, sub(hand, probe), 0.003 * size), gold);
        }
        const force = [...(own ?? (this.dark ? [1, 0.42, 0.36] : [0.72, 0.1, 0.08])), strength];
        const torque = [...(own ?? (this.dark ? [0.72, 0.6, 1] : [0.36, 0.2, 0.72])), strength];
        const name = (arrow) => arrow + (s.name ?? "");
        if (shown.force) this.arrow(name("hand_force"), hand, s.hand.force, all.scale.force, force, false);
        if (shown.torque) this.arrow(name("hand_torque"), hand, s.hand.torque, all.scale.torque, torque, true);
        const onProbe = [...(own ?? (this.dark ? [0.45, 0.85, 0.6] : [0.05, 0.45, 0.25])), strength];
        if (shown.probe_force) this.arrow(name("contact_force"), probe, s.contact.force, all.scale.force, onProbe, false);
      }, 0.28);
    }
  }
  asperity.Scene = Scene;
})();
