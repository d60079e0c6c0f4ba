// Curves, a histogram and a spectrogram on plain canvases.
"use strict";
(() => {
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  function begin(canvas) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    g.font = "11px ui-monospace, 'DejaVu Sans Mono', monospace";
    return { g, width, height };
  }

  const short = (x, digits = 3) => (x === 0 ? "0" : Number(x.toPrecision(digits)).toString());
  asperity.short = short;
  // In the unit that suits its size: 0.0031 s as "3.1 ms".
  asperity.amount = (x, unit, digits = 3) => {
    const size = Math.abs(x);
    if (size === 0 || !Number.isFinite(x)) return `0 ${unit}`;
    const steps = [[1, ""], [1e-3, "m"], [1e-6, "\u00b5"], [1e-9, "n"]];
    const [by, prefix] = steps.find(([s]) => size >= s) ?? steps[3];
    return `${short(x / by, digits)} ${prefix}${unit}`;
  };
  // 1, 2 or 5 times a power of ten, at most x.
  asperity.roundDown = (x) => {
    const ten = 10 ** Math.floor(Math.log10(x));
    return [5, 2, 1].map((f) => f * ten).find((v) => v <= x * (1 + 1e-9)) ?? ten;
  };

  const left = 62, bottom = 14;

  // The zero line, and what the top and the bottom stand for.
  function valueAxis(g, width, floor, zero, high, low) {
    g.strokeStyle = css("--line");
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(left, Math.round(zero) + 0.5);
    g.lineTo(width, Math.round(zero) + 0.5);
    g.stroke();
    g.fillStyle = css("--soft");
    g.textAlign = "right";
    g.textBaseline = "top";
    g.fillText(high, left - 4, 0);
    g.textBaseline = "bottom";
    g.fillText(low, left - 4, floor + 3);
  }

  function timeAxis(g, width, height, from, to) {
    g.fillStyle = css("--soft");
    g.textBaseline = "alphabetic";
    g.textAlign = "left";
    g.fillText(`${short(from, 5)} s`, left, height - 2);
    g.textAlign = "right";
    g.fillText(`${short(to, 5)} s`, width - 2, height - 2);
  }

  // Curves of columns of a history, or of their own. Of several rows on one pixel the least and the largest are drawn:
  // nothing is lost. Where a history has no rows there is no curve.
  asperity.drawCurves = (canvas, history, range, curves, cursor) => {
    const { g, width, height } = begin(canvas);
    const floor = height - bottom, top = 3;
    if (history.size < 2) return;
    const span = Math.max(1e-9, range.to - range.from);
    const x = (t) => left + ((width - left - 2) * (t - range.from)) / span;
    const columns = Math.max(1, Math.floor(width - left));
    let low = 0, high = 0;
    const lines = curves.map((c) => {
      const cells = new Float32Array(2 * columns).fill(NaN);
      const from = c.history ?? history, index = from.column[c.column], end = from.size > 0 ? from.rowAt(range.to) : -1;
      for (let row = from.rowAt(range.from); row <= end; ++row) {
        const v = c.of ? c.of(row) : from.value(row, index), time = from.time(row);
        if (Number.isNaN(v) || time > range.to || time < range.from - span / columns) continue;
        const cell = Math.min(columns - 1, Math.max(0, Math.floor(x(time) - left)));
        if (!(cells[2 * cell] <= v)) cells[2 * cell] = v;
        if (!(cells[2 * cell + 1] >= v)) cells[2 * cell + 1] = v;
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
      return cells;
    });
    if (high - low < (curves[0].least ?? 1e-12)) high = low + (curves[0].least ?? 1e-12);
    const y = (v) => floor - ((floor - top) * (v - low)) / (high - low);
    valueAxis(g, width, floor, y(0), asperity.amount(high, curves[0].unit, 2), asperity.amount(low, curves[0].unit, 2));
    lines.forEach((cells, i) => {
      g.strokeStyle = css(curves[i].colour);
      g.lineWidth = 1.4;
      g.beginPath();
      let begun = false;
      for (let cell = 0; cell < columns; ++cell) {
        if (Number.isNaN(cells[2 * cell])) continue;
        for (const v of [cells[2 * cell], cells[2 * cell + 1]]) {
          begun ? g.lineTo(left + cell + 0.5, y(v)) : g.moveTo(left + cell + 0.5, y(v));
          begun = true;
        }
      }
      g.stroke();
    });
    mark(g, x(cursor), floor);
    timeAxis(g, width, height, range.from, range.to);
  };

  function mark(g, x, floor) {
    g.strokeStyle = css("--accent");
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(x, 0);
    g.lineTo(x, floor);
    g.stroke();
  }

  // In place, radix 2.
  function transform(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; ++i) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) { [re[i], re[j]] = [re[j], re[i]]; [im[i], im[j]] = [im[j], im[i]]; }
    }
    for (let size = 2; size <= n; size <<= 1) {
      const angle = (-2 * Math.PI) / size;
      for (let at = 0; at < n; at += size) {
        for (let k = 0; k < size / 2; ++k) {
          const c = Math.cos(angle * k), s = Math.sin(angle * k), a = at + k, b = a + size / 2;
          const r = re[b] * c - im[b] * s, i = re[b] * s + im[b] * c;
          re[b] = re[a] - r; im[b] = im[a] - i; re[a] += r; im[a] += i;
        }
      }
    }
  }
  asperity.transform = transform;

  const window256 = Float64Array.from({ length: 256 }, (_, i) => 0.5 - 0.5 * Math.cos((2 * Math.PI * (i + 0.5)) / 256));
  const windowSum = window256.reduce((a, b) => a + b, 0);

  // Amplitude of the force on the hand at each of 128 frequencies over the 256 rows that end before `end`, N: the root of
  // the sum of squares of the three axes, so that it does not depend on where they point.
  asperity.spectrumAt = (history, end) => {
    const out = new Float64Array(128);
    const names = ["hand_fx", "hand_fy", "hand_fz"];
    for (const name of names) {
      const re = new Float64Array(256), im = new Float64Array(256), index = history.column[name];
      let mean = 0;
      for (let i = 0; i < 256; ++i) mean += history.value(end - 256 + i, index) / 256;
      for (let i = 0; i < 256; ++i) re[i] = (history.value(end - 256 + i, index) - mean) * window256[i];
      transform(re, im);
      for (let k = 1; k < 128; ++k) out[k] += (4 * (re[k] ** 2 + im[k] ** 2)) / windowSum ** 2;
    }
    return out.map(Math.sqrt);
  };

  // Spectra of histories over each other, each of the 256 rows before its `end`: amplitudes from 1 mN to 1 N.
  asperity.drawSpectra = (canvas, lines, periods) => {
    const { g, width, height } = begin(canvas);
    const floor = height - bottom, most = 0.5 / Math.min(...periods.filter((p) => p > 0));
    valueAxis(g, width, floor, floor, "1 N", "1 mN");
    lines.forEach((line, i) => {
      if (line.end - line.history.first < 256 || !(periods[i] > 0)) return;
      const amplitude = asperity.spectrumAt(line.history, line.end);
      g.strokeStyle = css(line.colour);
      g.lineWidth = 1.4;
      g.beginPath();
      for (let k = 1; k < 128; ++k) {
        const x = left + ((width - left - 2) * k) / (256 * periods[i] * most);
        const y = floor - floor * Math.max(0, Math.min(1, Math.log10(amplitude[k] / 1e-3) / 3));
        k > 1 ? g.lineTo(x, y) : g.moveTo(x, y);
      }
      g.stroke();
    });
    g.fillStyle = css("--soft");
    g.textBaseline = "alphabetic";
    g.textAlign = "left";
    g.fillText("0", left, height - 2);
    g.textAlign = "right";
    g.fillText(`${short(most)} Hz`, width - 2, height - 2);
  };

  const heat = asperity.heat;
  const heatAt = (share) => {
    const x = Math.max(0, Math.min(0.9999, share)) * (heat.length - 1), k = Math.floor(x);
    return heat[k].map((c, i) => c + (heat[k + 1][i] - c) * (x - k));
  };

  asperity.Spectrogram = class {
    constructor() { this.cache = new Map(); }
    // Amplitudes from 1 mN, about what a finger feels at its best, to 1 N.
    draw(canvas, history, range, cursor, period) {
      const { g, width, height } = begin(canvas);
      const floor = height - bottom;
      const [first, last] = [history.rowAt(range.from), history.rowAt(range.to)];
      const hop = Math.max(64, 64 * Math.ceil((last - first) / 64 / 160));
      const image = [];
      for (let end = Math.ceil(Math.max(history.first + 256, first) / hop) * hop; end <= last; end += hop) {
        const key = `${end}/${hop}`;
        if (!this.cache.has(key)) this.cache.set(key, asperity.spectrumAt(history, end));
        image.push([end, this.cache.get(key)]);
      }
      if (this.cache.size > 2000) this.cache.clear();
      const span = Math.max(1e-9, range.to - range.from);
      const x = (t) => left + ((width - left - 2) * (t - range.from)) / span;
      g.fillStyle = `rgb(${heat[0].join()})`;
      g.fillRect(left, 0, width - left - 2, floor);
      for (const [end, amplitude] of image) {
        const from = Math.max(left, x(history.time(end - 1) - hop * period)), to = x(history.time(end - 1));
        for (let k = 1; k < 128; ++k) {
          const share = Math.log10(amplitude[k] / 1e-3) / 3;
          if (!(share > 0)) continue;
          g.fillStyle = `rgb(${heatAt(share).map(Math.round).join()})`;
          g.fillRect(from, floor - (floor * (k + 1)) / 128, to - from + 0.6, floor / 128 + 0.6);
        }
      }
      g.fillStyle = css("--soft");
      g.textAlign = "right";
      g.textBaseline = "top";
      g.fillText(`${short(0.5 / period)} Hz`, left - 4, 0);
      g.textBaseline = "bottom";
      g.fillText("0", left - 4, floor + 3);
      mark(g, x(cursor), floor);
      timeAxis(g, width, height, range.from, range.to);
    }
  };

  // Times of ticks in steps of a twelfth of a decade; what is later than a period is red.
  asperity.drawTicks = (canvas, history, range, period) => {
    const { g, width, height } = begin(canvas);
    const floor = height - bottom, steps = 12, from = -6.5, to = -1.5;
    const counts = new Array(Math.round((to - from) * steps)).fill(0);
    const index = history.column.took, all = [];
    const [first, last] = history.size > 0 ? [history.rowAt(range.from), history.rowAt(range.to)] : [0, -1];
    for (let row = first; row <= last; ++row) {
      const took = history.value(row, index);
      if (!(took >= 0)) continue;
      all.push(took);
      const at = Math.floor((Math.log10(Math.max(took, 1e-9)) - from) * steps);
      ++counts[Math.max(0, Math.min(counts.length - 1, at))];
    }
    if (all.length === 0) return null;
    all.sort((a, b) => a - b);
    const most = Math.max(...counts), w = (width - left - 2) / counts.length;
    counts.forEach((n, i) => {
      if (n === 0) return;
      const late = 10 ** (from + (i + 0.5) / steps) > period;
      const h = Math.max(2, ((floor - 3) * Math.log10(1 + n)) / Math.log10(1 + most));
      g.fillStyle = css(late ? "--late" : "--accent");
      g.fillRect(left + i * w, floor - h, Math.max(1, w - 1), h);
    });
    g.strokeStyle = css("--late");
    const x = left + (Math.log10(period) - from) * steps * w;
    g.beginPath();
    g.moveTo(x, 0);
    g.lineTo(x, floor);
    g.stroke();
    g.fillStyle = css("--soft");
    g.textBaseline = "alphabetic";
    g.textAlign = "center";
    for (const e of [-6, -5, -4, -3, -2]) g.fillText(asperity.amount(10 ** e, "s", 1), left + (e - from) * steps * w, height - 2);
    g.textAlign = "right";
    g.textBaseline = "top";
    g.fillText(String(most), left - 4, 0);
    const share = (p) => all[Math.min(all.length - 1, Math.floor(p * all.length))];
    return { p50: share(0.5), p99: share(0.99), max: all[all.length - 1], late: all.filter((t) => t > period).length, count: all.length };
  };
})();
