// Where the page has its data from: a server, which is asked, or the page's own file.
"use strict";
const asperity = {};

(() => {
  const decode64 = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const element = (id) => document.getElementById(id);
  const token = new URLSearchParams(location.hash.slice(1)).get("token") || "";
  const headers = token === "" ? {} : { "X-Asperity-Token": token };

  // Data that the page brings along: an exported page has no server.
  asperity.isExported = () => element("data-scene") !== null;

  async function ask(path, as, options = {}) {
    const answer = await fetch(path, { headers, ...options });
    if (!answer.ok) throw new Error(`${answer.status}: ${(await answer.text()).trim()}`);
    return answer[as]();
  }

  asperity.loadScene = async () =>
    asperity.isExported() ? JSON.parse(element("data-scene").textContent) : ask("scene.json", "json");
  asperity.loadSession = async () => ask("session.json", "json");
  asperity.loadMesh = async (i) => readMesh(
    asperity.isExported() ? decode64(element(`data-mesh-${i}`).textContent) : await ask(`mesh/${i}`, "arrayBuffer"));
  asperity.loadRows = async (i) =>
    asperity.isExported() ? decode64(element(`data-rows-${i}`).textContent) : ask(`rows/${i}`, "arrayBuffer");
  asperity.tell = (what) =>
    fetch(`do?${what}`, { method: "POST", headers: { ...headers, "X-Asperity": "1" } }).catch(() => undefined);

  // shown_mesh.hpp says what the bytes are.
  function readMesh(bytes) {
    const head = new Uint32Array(bytes, 0, 4);
    if (head[0] !== 0x4d505341) throw new Error("a mesh that this page cannot read");
    const [, points, patches, vertices] = head;
    const range = new Float32Array(bytes, 16, 10);
    const shape = new Uint32Array(bytes, 56, 2 * patches);
    let at = 56 + 8 * patches;
    const corners = new Float32Array(bytes, at, 3 * vertices);
    at += 12 * vertices;
    const triangles = new Uint32Array(bytes, at, 3 * patches);
    at += 12 * patches;
    const places = new Uint16Array(bytes, at, 4 * points);
    at += 8 * points;
    const normals = new Int8Array(bytes, at, 4 * points);
    at += 4 * points;
    const errors = range[8] >= 0 ? new Uint16Array(bytes, at, points) : null;
    return { points, low: range.slice(0, 3), high: range.slice(3, 6), relief: range.slice(6, 8), places, normals, errors,
             shape, corners, triangles, indices: indicesOf(shape, patches) };
  }

  // Two triangles for each cell of a patch; the last row of a patch has come together in one point.
  function indicesOf(shape, patches) {
    let count = 0;
    for (let p = 0; p < patches; ++p) count += 3 * shape[2 * p] * (2 * shape[2 * p + 1] - 1);
    const out = new Uint32Array(count);
    let to = 0, first = 0;
    for (let p = 0; p < patches; ++p) {
      const columns = shape[2 * p], rows = shape[2 * p + 1], row = columns + 1;
      for (let j = 0; j < rows; ++j) {
        for (let i = 0; i < columns; ++i) {
          const a = first + j * row + i;
          out[to++] = a; out[to++] = a + 1; out[to++] = a + row;
          if (j + 1 < rows) { out[to++] = a + 1; out[to++] = a + row + 1; out[to++] = a + row; }
        }
      }
      first += row * (rows + 1);
    }
    return out;
  }

  // Rows of device ticks, as many as a page keeps; the oldest go.
  class History {
    constructor(columns, capacity) {
      this.width = columns.length;
      this.column = Object.fromEntries(columns.map((name, i) => [name, i]));
      this.capacity = capacity;
      this.times = new Float64Array(capacity);
      this.values = new Float32Array(capacity * this.width);
      this.end = 0;   // number of the row after the newest
      this.first = 0; // number of the oldest that is kept
      this.missed = 0;
    }
    add(bytes, at, rows) {
      const times = new Float64Array(bytes, at, rows);
      const values = new Float32Array(bytes, at + 8 * rows, this.width * rows);
      for (let i = 0; i < rows; ++i) {
        const slot = this.end % this.capacity;
        this.times[slot] = times[i];
        this.values.set(values.subarray(i * this.width, (i + 1) * this.width), slot * this.width);
        ++this.end;
      }
      this.first = Math.max(this.first, this.end - this.capacity);
    }
    clear() { this.first = this.end = 0; }
    get size() { return this.end - this.first; }
    time(row) { return this.times[row % this.capacity]; }
    value(row, column) { return this.values[(row % this.capacity) * this.width + column]; }
    some(row, name, count) {
      const at = (row % this.capacity) * this.width + this.column[name];
      return this.values.subarray(at, at + count);
    }
    // The last row that is not after this time.
    rowAt(time) {
      let low = this.first, high = this.end;
      while (low < high) {
        const middle = Math.floor((low + high) / 2);
        if (this.time(middle) <= time) low = middle + 1; else high = middle;
      }
      return Math.max(this.first, low - 1);
    }
  }
  asperity.History = History;

  // page_server.cpp says what a frame is. Each request acknowledges the frame before: a page that draws slowly asks less
  // often, and gets the newest all the same.
  asperity.follow = async (history, onFrame, onTrouble) => {
    let after = 0;
    for (;;) {
      let bytes;
      try {
        bytes = await ask(`frame?after=${after}`, "arrayBuffer");
      } catch (why) {
        onTrouble(why);
        await new Promise((later) => setTimeout(later, 500));
        continue;
      }
      const head = new DataView(bytes);
      const [rows, contacts, bodies, flags, dropped] = [4, 8, 12, 16, 20].map((at) => head.getUint32(at, true));
      const next = head.getFloat64(32, true), missed = head.getFloat64(40, true);
      if (next - rows < after) history.clear();
      history.add(bytes, 56, rows);
      if (after > 0) history.missed += missed;
      const restarted = next < after;
      after = next;
      let at = 56 + rows * (8 + 4 * history.width);
      const list = new Float32Array(bytes.slice(at, at + 32 * contacts));
      at += 32 * contacts;
      const poses = new Float32Array(bytes.slice(at, at + 28 * bodies));
      at += 28 * bodies;
      const probe = Array.from(new Float32Array(bytes.slice(at, at + 28)));
      onFrame({ rows, contacts: list, poses, probe, dropped, paused: (flags & 1) !== 0, over: (flags & 2) !== 0,
                speed: head.getFloat64(48, true), restarted });
      if ((flags & 2) !== 0 && rows === 0) return;
      await new Promise((drawn) => requestAnimationFrame(drawn));
    }
  };
})();
