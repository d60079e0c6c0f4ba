// The scene in three dimensions: bodies, hand, contacts and arrows, on WebGL 2.
"use strict";
(() => {
  // Vectors and quaternions (x y z w) are arrays; matrices are columns, as WebGL takes them.
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = (a) => Math.hypot(a[0], a[1], a[2]);
  const unit = (a) => times(1 / (length(a) || 1), a);
  const turn = (q, v) => {
    const t = times(2, cross(q, v));
    return add(add(v, times(q[3], t)), cross(q, t));
  };
  const poseMatrix = (p, q, scale = 1) => {
    const [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => times(scale, turn(q, axis)));
    return [...x, 0, ...y, 0, ...z, 0, ...p, 1];
  };
  // Takes the unit shape along +z to one from `from` along `along`, so thick across.
  const along = (from, way, thick) => {
    const z = unit(way);
    const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
    return [...times(thick, x), 0, ...times(thick, cross(z, x)), 0, ...way, 0, ...from, 1];
  };
  const multiply = (a, b) => {
    const out = new Array(16).fill(0);
    for (let c = 0; c < 4; ++c) for (let r = 0; r < 4; ++r) for (let k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    return out;
  };
  Object.assign(asperity, { vectors: { add, sub, times, dot, cross, length, unit, turn } });

  const bodyVertex = `#version 300 es
    uniform mat4 view, model;
    uniform vec3 low, size;
    layout(location = 0) in vec4 place;  // share of the box, and of the relief's range
    layout(location = 1) in vec4 normalAndPiece;
    out vec3 normal, world;
    out float relief;
    flat out int piece;
    void main() {
      vec4 w = model * vec4(low + size * place.xyz, 1.0);
      world = w.xyz;
      normal = mat3(model) * (normalAndPiece.xyz / 127.0);
      relief = place.w;
      piece = int(normalAndPiece.w);
      gl_Position = view * w;
    }`;
  // One key light from beside the viewer rakes over the surface, so that small relief throws tones; the sky fills.
  const bodyFragment = `#version 300 es
    precision highp float;
    uniform vec3 eye, key, clay, colours[8];
    uniform vec3 scaleLow, scaleMiddle, scaleHigh;
    uniform float zero;
    uniform int paint;
    in vec3 normal, world;
    in float relief;
    flat in int piece;
    out vec4 colour;
    void main() {
      vec3 n = normalize(normal);
      vec3 toEye = normalize(eye - world);
      float lit = max(dot(n, key), 0.0);
      float sky = 0.5 + 0.5 * n.z;
      float shine = pow(max(dot(n, normalize(key + toEye)), 0.0), 40.0);
      vec3 base = clay;
      if (paint == 1) {
        base = relief < zero ? mix(scaleLow, scaleMiddle, relief / max(zero, 1e-6))
                             : mix(scaleMiddle, scaleHigh, (relief - zero) / max(1.0 - zero, 1e-6));
      } else if (paint == 2) {
        base = colours[piece];
      }
      vec3 light = base * (0.16 + 0.22 * sky + 0.78 * lit) + 0.10 * shine;
      colour = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);
    }`;
  const partVertex = `#version 300 es
    uniform mat4 view, model;
    layout(location = 0) in vec3 place;
    layout(location = 1) in vec3 across;
    out vec3 normal;
    void main() {
      normal = mat3(model) * across;
      gl_Position = view * (model * vec4(place, 1.0));
    }`;
  const partFragment = `#version 300 es
    precision highp float;
    uniform vec4 tint;
    uniform vec3 key;
    uniform float shaded;
    in vec3 normal;
    out vec4 colour;
    void main() {
      float light = mix(1.0, 0.72 + 0.28 * abs(dot(normalize(normal), key)), shaded);
      colour = vec4(tint.rgb * light, tint.a);
    }`;

  function program(gl, vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    const at = {};
    for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); ++i) {
      const name = gl.getActiveUniform(made, i).name.replace("[0]", "");
      at[name] = gl.getUniformLocation(made, name);
    }
    return { made, at };
  }

  // A solid of revolution about z: profile of [radius, height], as triangles with normals.
  function revolve(profile, sides = 24) {
    const out = [];
    for (let k = 0; k + 1 < profile.length; ++k) {
      const [[r0, z0], [r1, z1]] = [profile[k], profile[k + 1]];
      const n = unit([z1 - z0, 0, r0 - r1]);
      for (let s = 0; s < sides; ++s) {
        const [a, b] = [s, s + 1].map((i) => (2 * Math.PI * i) / sides);
        const point = (r, z, t) => [r * Math.cos(t), r * Math.sin(t), z];
        const across = (t) => [n[0] * Math.cos(t), n[0] * Math.sin(t), n[2]];
        for (const [r, z, t] of [[r0, z0, a], [r0, z0, b], [r1, z1, b], [r0, z0, a], [r1, z1, b], [r1, z1, a]]) {
          out.push(...point(r, z, t), ...across(t));
        }
      }
    }
    return new Float32Array(out);
  }
  const ball = Array.from({ length: 13 }, (_, i) => [Math.sin((Math.PI * i) / 12), -Math.cos((Math.PI * i) / 12)]);
  const shapes = {
    rod: revolve([[0, 0], [1, 0], [1, 1], [0, 1]]),
    cone: revolve([[0, 0], [1, 0], [0, 1]]),
    ball: revolve(ball),
    disc: revolve([[0, 0], [1, 0]], 32),
    ring: revolve([[0.86, -0.07], [1, 0], [0.86, 0.07], [0.86, -0.07]], 40),
  };

  class Scene {
    constructor(canvas, description) {
      const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: false });
      if (gl === null) throw new Error("This browser has no WebGL 2: the scene is not drawn, the panels are.");
      this.canvas = canvas;
      this.gl = gl;
      this.body = program(gl, bodyVertex, bodyFragment);
      this.part = program(gl, partVertex, partFragment);
      this.shapes = Object.fromEntries(Object.entries(shapes).map(([name, data]) => [name, this.buffer(data)]));
      this.bodies = description.bodies.map((b) => ({ ...b, mesh: null, shown: true }));
      this.camera = { at: [0, 0, 0], distance: 1, yaw: -0.9, pitch: 0.5 };
      this.paint = "clay";
      this.dark = false;
      this.drawn = { arrows: {} };
      this.listen();
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
      gl.bindVertexArray(null);
      this.bodies[i].mesh = { vao, count: mesh.indices.length, low: mesh.low, relief: mesh.relief,
                              size: mesh.high.map((h, k) => h - mesh.low[k]) };
    }

    // Box of all bodies where they are, in the world.
    box() {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (const b of this.bodies) {
        if (b.mesh === null) continue;
        for (let corner = 0; corner < 8; ++corner) {
          const p = [0, 1, 2].map((k) => b.mesh.low[k] + ((corner >> k) & 1) * b.mesh.size[k]);
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

    listen() {
      const held = new Map();
      const c = this.canvas;
      let led = null;  // the pointer that leads the hand
      c.addEventListener("pointerdown", (e) => {
        c.setPointerCapture(e.pointerId);
        held.set(e.pointerId, [e.clientX, e.clientY]);
        if (held.size === 1 && this.lead?.takes(e.offsetX, e.offsetY)) led = e.pointerId;
      });
      const release = (e) => { held.delete(e.pointerId); if (led === e.pointerId) led = null; };
      c.addEventListener("pointerup", release);
      c.addEventListener("pointercancel", release);
      c.addEventListener("contextmenu", (e) => e.preventDefault());
      c.addEventListener("pointermove", (e) => {
        const before = held.get(e.pointerId);
        if (before === undefined) return;
        const moved = [e.clientX - before[0], e.clientY - before[1]];
        if (led === e.pointerId && held.size === 1) {
          const turns = e.buttons === 2 || e.altKey;
          this.lead.drag(...moved, turns ? "turn" : e.shiftKey ? "deep" : "move");
        } else if (held.size === 2) {
          const other = [...held.entries()].find(([id]) => id !== e.pointerId)[1];
          const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
          this.zoom(gap(before) / gap([e.clientX, e.clientY]));
          this.pan(moved[0] / 2, moved[1] / 2);
        } else if (e.shiftKey || e.buttons === 2 || e.buttons === 4) {
          this.pan(...moved);
        } else {
          this.rotate(-0.008 * moved[0], 0.008 * moved[1]);
        }
        held.set(e.pointerId, [e.clientX, e.clientY]);
      });
      c.addEventListener("wheel", (e) => {
        e.preventDefault();
        if (led !== null) { this.lead.drag(0, 0.2 * e.deltaY, "deep"); return; }
        this.zoom(Math.exp(0.0012 * e.deltaY));
      }, { passive: false });
      c.addEventListener("keydown", (e) => {
        const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
        const way = arrows[e.key];
        if (way !== undefined) e.shiftKey ? this.pan(-20 * way[0], 20 * way[1]) : this.rotate(0.1 * way[0], 0.1 * way[1]);
        else if (e.key === "+" || e.key === "=") this.zoom(1 / 1.15);
        else if (e.key === "-") this.zoom(1.15);
        else if (e.key === "0") this.lookFrom("corner");
        else if (this.lead?.key(e.key.toLowerCase(), e.shiftKey)) { /* the hand was led */ }
        else return;
        e.preventDefault();
      });
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
      if (state !== null) this.drawParts(state);
    }

    drawBodies(view) {
      const gl = this.gl, at = this.body.at;
      gl.useProgram(this.body.made);
      gl.uniformMatrix4fv(at.view, false, view.matrix);
      gl.uniform3fv(at.eye, view.eye);
      gl.uniform3fv(at.key, view.key);
      gl.uniform1i(at.paint, { clay: 0, relief: 1, pieces: 2 }[this.paint] ?? 0);
      gl.uniform3fv(at.scaleLow, [0.05, 0.19, 0.52]);
      gl.uniform3fv(at.scaleMiddle, [0.72, 0.72, 0.70]);
      gl.uniform3fv(at.scaleHigh, [0.75, 0.24, 0.02]);
      gl.uniform3fv(at.colours, [0.40, 0.58, 0.78, 0.80, 0.58, 0.34, 0.26, 0.52, 0.42, 0.76, 0.46, 0.58,
                                 0.80, 0.76, 0.42, 0.38, 0.36, 0.66, 0.60, 0.80, 0.80, 0.66, 0.32, 0.24]);
      this.bodies.forEach((b, i) => {
        if (b.mesh === null || !b.shown) return;
        gl.uniformMatrix4fv(at.model, false, poseMatrix(b.pose.slice(0, 3), b.pose.slice(3)));
        gl.uniform3fv(at.low, b.mesh.low);
        gl.uniform3fv(at.size, b.mesh.size);
        gl.uniform3fv(at.clay, b.probe ? [0.60, 0.47, 0.30] : i % 2 === 1 ? [0.50, 0.53, 0.55] : [0.46, 0.50, 0.44]);
        const [low, high] = b.mesh.relief;
        gl.uniform1f(at.zero, high > low ? -low / (high - low) : 0.5);
        gl.bindVertexArray(b.mesh.vao);
        gl.drawElements(gl.TRIANGLES, b.mesh.count, gl.UNSIGNED_INT, 0);
      });
      gl.bindVertexArray(null);
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

    drawParts(s) {
      const gl = this.gl, size = this.size;
      const shown = s.shown;
      // Arrows and the hand are what people look for: they are seen through bodies, faintly.
      const both = (paint, hidden = 0.28) => {
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthFunc(gl.GREATER);
        gl.depthMask(false);
        paint(hidden);
        gl.depthMask(true);
        gl.depthFunc(gl.LEQUAL);
        paint(1);
        gl.disable(gl.BLEND);
      };
      if (shown.contacts) {
        this.drawn.contacts = s.contacts.length;
        both((strength) => {
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
      both((strength) => {
        const hand = s.target.centre, probe = s.probe.centre;
        if (shown.hand) {
          this.shape("ball", poseMatrix(hand, [0, 0, 0, 1], 0.012 * size), [...(this.dark ? [0.95, 0.85, 0.4] : [0.55, 0.40, 0.0]), strength]);
        }
        if (shown.coupling && length(sub(hand, probe)) > 1e-9) {
          this.shape("rod", along(probe, sub(hand, probe), 0.003 * size), [...(this.dark ? [0.95, 0.85, 0.4] : [0.55, 0.40, 0.0]), strength]);
        }
        const force = this.dark ? [1, 0.42, 0.36, strength] : [0.72, 0.1, 0.08, strength];
        const torque = this.dark ? [0.72, 0.6, 1, strength] : [0.36, 0.2, 0.72, strength];
        if (shown.force) this.arrow("hand_force", hand, s.hand.force, s.scale.force, force, false);
        if (shown.torque) this.arrow("hand_torque", hand, s.hand.torque, s.scale.torque, torque, true);
        const onProbe = this.dark ? [0.45, 0.85, 0.6, strength] : [0.05, 0.45, 0.25, strength];
        if (shown.probe_force) this.arrow("contact_force", probe, s.contact.force, s.scale.force, onProbe, false);
      });
    }
  }
  asperity.Scene = Scene;
})();
