// Leads the simulated hand: by a pointer that drags the probe, and by keys.
"use strict";
(() => {
  const { add, sub, times, length, unit } = asperity.vectors;
  // Quaternions are x y z w.
  const product = (a, b) => [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
  const about = (axis, angle) => [...times(Math.sin(0.5 * angle), unit(axis)), Math.cos(0.5 * angle)];

  class Lead {
    // `state()` is what the page shows: where the probe and the hand are now.
    constructor(scene, state) {
      this.scene = scene;
      this.state = state;
      this.goal = null;  // where the probe's body frame is wanted: {p, q}
      this.asked = null;
      this.busy = false;
    }

    // Whether a pointer at this place of the canvas has hold of the probe.
    takes(x, y) {
      const now = this.state();
      if (now === null) return false;
      const at = this.scene.onCanvas(now.probe.centre);
      const reach = Math.max(24, (0.4 * this.scene.bodies[0].size_m) / at.pixel);
      if (Math.hypot(x - at.x, y - at.y) > reach) return false;
      this.begin(now);
      return true;
    }

    begin(now) {
      if (this.goal === null) this.goal = { p: now.target.p, q: now.target.q, c: sub(now.target.centre, now.target.p) };
    }

    // So many pixels to the right and down: across the view, into it, or as a turn about the view's axes.
    drag(x, y, how) {
      const now = this.state();
      if (now === null) return;
      const { right, up, back } = this.scene.axes(), pixel = this.scene.onCanvas(now.probe.centre).pixel;
      if (how === "turn") this.turn(add(times(0.008 * x, up), times(0.008 * y, right)));
      else if (how === "deep") this.move(times(pixel * y, back));
      else this.move(add(times(pixel * x, right), times(-pixel * y, up)));
    }

    // Keys of one hand: a d across, w s up and down, q e into the view and out of it; with Shift they turn.
    key(name, turns) {
      const keys = { a: [-1, 0, 0], d: [1, 0, 0], w: [0, 1, 0], s: [0, -1, 0], q: [0, 0, -1], e: [0, 0, 1] };
      const way = keys[name], now = this.state();
      if (way === undefined || now === null) return false;
      this.begin(now);
      const { right, up, back } = this.scene.axes();
      const world = add(add(times(way[0], right), times(way[1], up)), times(way[2], back));
      if (turns) this.turn(times(0.05, world));
      else this.move(times(Math.min(0.001, 0.005 * this.scene.size), world));
      return true;
    }

    move(way) {
      this.goal.p = add(this.goal.p, way);
      this.tell();
    }

    // About the probe's centre of mass, which stays.
    turn(by) {
      const angle = length(by);
      if (!(angle > 1e-9)) return;
      const rotation = about(by, angle), centre = add(this.goal.p, this.goal.c);
      this.goal.c = asperity.vectors.turn(rotation, this.goal.c);
      const q = product(rotation, this.goal.q), size = Math.hypot(...q);
      this.goal.q = q.map((x) => x / size);
      this.goal.p = sub(centre, this.goal.c);
      this.tell();
    }

    // One request at a time: the newest goal goes out when the one before has arrived.
    async tell() {
      this.asked = [...this.goal.p, ...this.goal.q];
      if (this.busy) return;
      this.busy = true;
      while (this.asked !== null) {
        const pose = this.asked;
        this.asked = null;
        await asperity.tell(`hand=${pose.map((x) => x.toFixed(9)).join()}`);
      }
      this.busy = false;
    }
  }
  asperity.Lead = Lead;
})();
