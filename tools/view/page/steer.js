// Pointer and keys on the canvas: they turn, move and zoom the view, or lead the hand.
"use strict";
asperity.steer = (scene) => {
  const held = new Map();
  const c = scene.canvas;
  let led = null;  // the pointer that leads the hand
  c.addEventListener("pointerdown", (e) => {
    c.setPointerCapture(e.pointerId);
    held.set(e.pointerId, [e.clientX, e.clientY]);
    if (held.size === 1 && scene.lead?.takes(e.offsetX, e.offsetY)) led = e.pointerId;
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
      scene.lead.drag(...moved, turns ? "turn" : e.shiftKey ? "deep" : "move");
    } else if (held.size === 2) {
      const other = [...held.entries()].find(([id]) => id !== e.pointerId)[1];
      const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      scene.zoom(gap(before) / gap([e.clientX, e.clientY]));
      scene.pan(moved[0] / 2, moved[1] / 2);
    } else if (e.shiftKey || e.buttons === 2 || e.buttons === 4) {
      scene.pan(...moved);
    } else {
      scene.rotate(-0.008 * moved[0], 0.008 * moved[1]);
    }
    held.set(e.pointerId, [e.clientX, e.clientY]);
  });
  c.addEventListener("wheel", (e) => {
    e.preventDefault();
    if (led !== null) { scene.lead.drag(0, 0.2 * e.deltaY, "deep"); return; }
    scene.zoom(Math.exp(0.0012 * e.deltaY));
  }, { passive: false });
  c.addEventListener("keydown", (e) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const way = arrows[e.key];
    if (way !== undefined) e.shiftKey ? scene.pan(-20 * way[0], 20 * way[1]) : scene.rotate(0.1 * way[0], 0.1 * way[1]);
    else if (e.key === "+" || e.key === "=") scene.zoom(1 / 1.15);
    else if (e.key === "-") scene.zoom(1.15);
    else if (e.key === "0") scene.lookFrom("corner");
    else if (scene.lead?.key(e.key.toLowerCase(), e.shiftKey)) { /* the hand was led */ }
    else return;
    e.preventDefault();
  });
};
