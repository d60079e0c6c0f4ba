#!/usr/bin/python3 -P
"""bench.py PROBE.glb FIXED.glb: what a call from Python costs over C++, and what threads bring to a batch and to pairs that go on together.

The bodies are far apart for the first, so that a step costs C++ next to nothing: step_batch() on one thread makes the
same steps in C++ without Python between them, and the difference per pose is what Python costs. The two alternate in
one run, and of each the median and the least of the rounds are told.
"""

import argparse
import os
import statistics
import time

import numpy as np

import asperity


def seconds(work):
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def far_poses(probe, fixed, count):
    out = np.zeros((count, 7))
    out[:, 6] = 1.0
    out[:, 2] = 10.0 * (probe.diagonal_m + fixed.diagonal_m)
    return out


def light_touches(probe, fixed, count, seed):
    """From a gap of a quarter of a millimetre to as much overlap, turned by up to 30 mrad."""
    random = np.random.default_rng(seed)
    out = np.zeros((count, 7))
    out[:, :2] = random.uniform(-1e-3, 1e-3, (count, 2))
    out[:, 2] = fixed.high[2] - probe.low[2] + 5e-4 + random.uniform(-2.5e-4, 2.5e-4, count)
    out[:, 3:6] = random.uniform(-0.015, 0.015, (count, 3))
    out[:, 6] = np.sqrt(1.0 - np.sum(out[:, 3:6] ** 2, axis=1))
    return out


def tell_overhead(renderer, poses, rounds):
    rows = list(poses)

    def one_by_one():
        step = renderer.step
        for pose in rows:
            step(pose)

    calls, batches = [], []
    for _ in range(rounds):
        calls.append(seconds(one_by_one) / len(rows))
        batches.append(seconds(lambda: renderer.step_batch(poses, threads=1)) / len(rows))
    for word, of in (("median", statistics.median), ("least", min)):
        call, batch = 1e6 * of(calls), 1e6 * of(batches)
        print(f"step(), {word} of {rounds}: {call:.2f} us a call, in C++ {batch:.2f} us: Python costs {call - batch:.2f} us")


def tell_batch(renderer, poses, rounds, threads):
    renderer.step_batch(poses[:64], threads=threads)  # makes the renderers of the other threads
    ratios = []
    for _ in range(rounds):
        begin = time.perf_counter()
        alone = renderer.step_batch(poses, threads=1)
        middle = time.perf_counter()
        together = renderer.step_batch(poses, threads=threads)
        ratios.append((middle - begin) / (time.perf_counter() - middle))
        if alone.tobytes() != together.tobytes():
            raise SystemExit("the two batches have different bits")
    told = ", ".join(f"{r:.2f}" for r in ratios)
    print(f"step_batch() of {len(poses)} poses on {threads} threads: {told} times as fast as on one, the same bits")


def tell_each(probe, fixed, formulation, pairs, rounds, threads):
    """Pairs that go on together beside one after the other: contacts a second and core."""
    renderers = [asperity.Renderer(probe, fixed, formulation=formulation) for _ in range(pairs)]
    poses = light_touches(probe, fixed, pairs, seed=2)
    contacts = sum(len(r.query(pose).contacts) for r, pose in zip(renderers, poses))
    rows = list(zip(renderers, poses))

    def one_by_one():
        for renderer, pose in rows:
            renderer.step(pose)

    ways = {"step() of each": (one_by_one, 1)}
    for n in sorted({1, threads}):
        ways[f"step_each() on {n}"] = (lambda n=n: asperity.step_each(renderers, poses, threads=n), n)
    took = {name: [] for name in ways}
    for _ in range(rounds):
        for name, (work, _) in ways.items():
            took[name].append(seconds(work))
    for name, (_, cores) in ways.items():
        median = statistics.median(took[name])
        print(f"{pairs} pairs, {name}: {1e3 * median:.2f} ms, {contacts / median / cores:.0f} contacts/s and core")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("probe")
    parser.add_argument("fixed")
    parser.add_argument("--calls", type=int, default=20000)
    parser.add_argument("--poses", type=int, default=4096)
    parser.add_argument("--pairs", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    given = parser.parse_args()
    probe, fixed = asperity.load(given.probe), asperity.load(given.fixed)
    for formulation in ("least-motion", "planes"):
        print(formulation)
        renderer = asperity.Renderer(probe, fixed, formulation=formulation)
        tell_overhead(renderer, far_poses(probe, fixed, given.calls), given.rounds)
        if formulation == "least-motion" and given.threads > 1:
            tell_batch(renderer, light_touches(probe, fixed, given.poses, seed=1), given.rounds, given.threads)
        tell_each(probe, fixed, formulation, given.pairs, given.rounds, given.threads)


if __name__ == "__main__":
    main()
