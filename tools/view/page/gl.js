// What the scene is drawn with: vectors and matrices, programs of WebGL 2 and simple shapes.
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
  Object.assign(asperity, { vectors: { add, sub, times, dot, cross, length, unit, turn }, matrices: { poseMatrix, along, multiply } });

  const bodyVertex = `#version 300 es
    uniform mat4 view, model;
    uniform vec3 low, size;
    layout(location = 0) in vec4 place;  // share of the box, and of the relief's range
    layout(location = 1) in vec4 normalAndPiece;
    layout(location = 2) in float distanceShare;  // of the errors' range
    out vec3 normal, world;
    out float relief, apart;
    flat out int piece;
    void main() {
      vec4 w = model * vec4(low + size * place.xyz, 1.0);
      world = w.xyz;
      normal = mat3(model) * (normalAndPiece.xyz / 127.0);
      relief = place.w;
      apart = distanceShare;
      piece = int(normalAndPiece.w);
      gl_Position = view * w;
    }`;
  // One key light from beside the viewer rakes over the surface, so that small relief throws tones; the sky fills.
  const bodyFragment = `#version 300 es
    precision highp float;
    uniform vec3 eye, key, clay, colours[8], heat[7];
    uniform vec3 scaleLow, scaleMiddle, scaleHigh;
    uniform float zero, alpha;
    uniform int paint;
    in vec3 normal, world;
    in float relief, apart;
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
      } else if (paint == 3) {
        float x = clamp(apart, 0.0, 0.9999) * 6.0;
        base = mix(heat[int(x)], heat[int(x) + 1], fract(x));
      }
      // Values are shaded weakly, so that a colour stays the one of the scale.
      bool value = paint == 1 || paint == 3;
      vec3 light = value ? base * (0.72 + 0.28 * lit) : base * (0.16 + 0.22 * sky + 0.78 * lit) + 0.10 * shine;
      colour = vec4(paint == 4 ? vec3(0.08) : pow(light, vec3(1.0 / 2.2)), alpha);
    }`;
  // Colours of values, sRGB. Dark blue over violet and orange to light yellow for what has no sign: lightness grows
  // evenly. Blue over grey to orange for what has one.
  asperity.heat = [[13, 8, 35], [66, 20, 110], [140, 41, 99], [212, 72, 66], [246, 138, 40], [252, 205, 85], [252, 253, 200]];
  const linear = (c) => c.map((v) => (v / 255) ** 2.2);
  const encoded = (c) => c.map((v) => Math.round(255 * v ** (1 / 2.2)));
  const about = [[0.05, 0.19, 0.52], [0.72, 0.72, 0.70], [0.75, 0.24, 0.02]];
  Object.assign(asperity, { heatLinear: asperity.heat.flatMap(linear), aboutZero: about, aboutZeroShown: about.map(encoded) });

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
  Object.assign(asperity, { shapes, programs: { make: program, bodyVertex, bodyFragment, partVertex, partFragment } });
})();
