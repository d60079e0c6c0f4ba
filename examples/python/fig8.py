#!/usr/bin/python3
"""fig8.py [-o FOLDER]: Fig. 8 of Otaduy, Jain, Sud and Lin (2004) from Python, with asperity and numpy alone.

Two striped blocks lie on each other, ridges in grooves. The upper one is pressed down with 1 N and turned about the normal,
step by step: at each angle it is put where the contact bears the newton. It rises as soon as it is turned, and the contact turns
it back. What `asperity experiment fig8` shows with a hand and a control loop is here asked of the renderer alone, at rest.
"""

import argparse
import csv
import os

import numpy as np

import asperity

# The block: 42 x 38 x 20 mm, ridges along x of 4 mm wavelength, which run out into the valleys over the last 2 mm.
HALF = np.array([21e-3, 19e-3, 10e-3])
RUN_OUT, WAVELENGTH, AMPLITUDE = 2e-3, 4e-3, 0.5e-3
FULL_HALF_LENGTH = HALF[0] - RUN_OUT
PRESS_N = 1.0
# From here on somewhere crest meets crest, and the block slides level.
SATURATION = 0.5 * WAVELENGTH / FULL_HALF_LENGTH

# Name, Renderer()'s settings, and what the kind's depth is: the largest overlap or a soft maximum of it.
KINDS = {
    "window_central": ({"formulation": "window", "gradient": "central"}, "largest"),
    "window_soft": ({"formulation": "window", "gradient": "soft"}, "soft"),
    "least_motion": ({"formulation": "least-motion"}, "largest"),
}


def ridges(x, y):
    """Heights (N,) of the top and of the bottom over their mid planes, m."""
    t = np.clip((HALF[0] - np.abs(x)) / RUN_OUT, 0.0, 1.0)
    share = t * t * (3.0 - 2.0 * t)
    ridge = share * AMPLITUDE * np.cos(2.0 * np.pi / WAVELENGTH * y)
    sunk = (1.0 - share) * AMPLITUDE
    return ridge - sunk, ridge + sunk


def box_mesh(lines, breaks, bend):
    """The surface of a box whose faces are cut at `lines` (x, y, z), slab by slab between breaks along x, each point moved by
    bend((N, 3)). Points and triangles are in the order of the command's own mesh, so that it bakes to the same texture."""
    quads, outward = [], []
    for first, last in zip(np.searchsorted(lines[0], breaks), np.searchsorted(lines[0], breaks[1:])):
        spans = [(first, last), (0, len(lines[1]) - 1), (0, len(lines[2]) - 1)]
        for axis in range(3):
            b, c = (axis + 1) % 3, (axis + 2) % 3
            i, j = (k.ravel() for k in np.meshgrid(range(*spans[b]), range(*spans[c]), indexing="ij"))
            for end in spans[axis]:
                if 0 < end < len(lines[axis]) - 1:
                    continue  # the next slab goes on there
                corners = np.empty((len(i), 4, 3), dtype=np.int64)
                corners[:, :, axis] = end
                for n, (right, up) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)]):
                    corners[:, n, b], corners[:, n, c] = i + right, j + up
                quads.append(corners)
                outward += [end > 0] * len(i)
    at = np.concatenate(quads).reshape(-1, 3)
    unique, first, rows = np.unique(at, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)  # by first use
    vertices = bend(np.stack([lines[k][unique[order, k]] for k in range(3)], axis=1))
    q = np.argsort(order)[rows].reshape(-1, 4)
    q = np.where(np.array(outward)[:, None], q, q[:, ::-1])
    # Along the shorter diagonal.
    long_way = np.sum((vertices[q[:, 2]] - vertices[q[:, 0]]) ** 2, axis=1)
    other = np.sum((vertices[q[:, 3]] - vertices[q[:, 1]]) ** 2, axis=1)
    cut = np.where((other < (1.0 - 1e-6) * long_way)[:, None], q[:, [0, 1, 3, 1, 2, 3]], q[:, [0, 1, 2, 0, 2, 3]])
    return asperity.Mesh(vertices, cut.reshape(-1, 3))


def cuts(breaks, cells):
    """Lines of one axis: so many cells between one break and the next."""
    parts = [a + (b - a) / n * np.arange(n) for a, b, n in zip(breaks, breaks[1:], cells)]
    return np.concatenate([*parts, breaks[-1:]])


def striped_block():
    """(full mesh, coarse mesh) of the block."""
    x = np.array([-HALF[0], -FULL_HALF_LENGTH, FULL_HALF_LENGTH, HALF[0]])

    def with_ridges(p):
        top, bottom = ridges(p[:, 0], p[:, 1])
        p[:, 2] += np.where(p[:, 2] >= HALF[2], top, 0.0) + np.where(p[:, 2] <= -HALF[2], bottom, 0.0)
        return p

    def with_low_ends(p):
        p[:, 2] -= np.where(np.abs(p[:, 0]) >= HALF[0], np.copysign(AMPLITUDE, p[:, 2]), 0.0)
        return p

    full = [cuts(x, [16, 24, 16]), cuts(HALF[1] * np.array([-1, 1]), [608]), cuts(HALF[2] * np.array([-1, 1]), [16])]
    coarse = [x, HALF[1] * np.array([-1, 1]), HALF[2] * np.array([-1, 1])]
    return box_mesh(full, x, with_ridges), box_mesh(coarse, x, with_low_ends)


def block_at(z, angle):
    """A pose (7,): at that height, turned by that angle about z."""
    return np.array([0.0, 0.0, z, 0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)])


def lies_at(renderer, angle, z):
    """(height in m, Touch) at which the contact bears the press, sought from the height z downwards and up."""
    low, high = z - 2e-3, z + 2e-3  # too much force, too little
    for _ in range(60):
        touch = renderer.query(block_at(z, angle))
        missing = PRESS_N - touch.force[2]
        if abs(missing) < 1e-6 * PRESS_N:
            break
        low, high = (low, z) if missing > 0.0 else (z, high)
        slope = touch.stiffness[2, 2]  # N/m, below 0
        step = z + missing / slope if slope < -1.0 else high
        z = step if low < step < high else 0.5 * (low + high)
    return z, touch


def turned(block, angles, **kind):
    """Rows (N, 4) of angle (rad), rise (m), force along z (N) and torque about z (N m), the block at rest at each angle."""
    renderer = asperity.Renderer(block, block, **kind)
    rest, _ = lies_at(renderer, 0.0, 2.0 * HALF[2])
    out, z = [], rest
    for angle in angles:
        z, touch = lies_at(renderer, angle, z)
        out.append([angle, z - rest, touch.force[2], touch.torque[2]])
    return np.array(out)


def rise_by_brute_force(angles, depth):
    """What geometry asks for (N,), m: over the formulas of both surfaces, without a mesh, a texture or a window."""
    step = 1e-4 if depth == "largest" else 2e-4
    x, y = (np.arange(-half + 0.5 * step, half, step) for half in HALF[:2])
    x, y = (k.ravel() for k in np.meshgrid(x[x > 0.0], y))  # half a turn takes both blocks into themselves
    softness = 0.02 * peak_to_valley()

    def at(angle):
        c, s = np.cos(angle), np.sin(angle)
        ax, ay = c * x + s * y, c * y - s * x
        inside = (np.abs(ax) <= HALF[0]) & (np.abs(ay) <= HALF[1])
        overlap = (ridges(x, y)[0] - ridges(ax, ay)[1])[inside]
        return max(0.0, overlap.max()) if depth == "largest" else softness * np.log(np.mean(np.exp(overlap / softness)))

    return np.array([at(abs(angle)) for angle in angles])


def peak_to_valley():
    """Of the sine whose height varies as that of the block's whole surface does, its level sides included, m."""
    lx, ly, lz = 2.0 * HALF
    x, y = np.meshgrid(((np.arange(400) + 0.5) / 400 - 0.5) * lx, ((np.arange(380) + 0.5) / 380 - 0.5) * ly)
    top, bottom = ridges(x.ravel(), y.ravel())
    share = lx * ly / (400 * 380) / (2.0 * (lx * ly + lx * lz + ly * lz))
    height, square = np.sum(top - bottom), np.sum(top**2 + bottom**2)
    return 2.0 * np.sqrt(2.0) * np.sqrt(share * square - (share * height) ** 2)


def torque_by_closed_form(angles, force):
    """F a K w cos(K w theta / 2) up to saturation and none beyond (N,), N m, against the turn."""
    k_w = 2.0 * np.pi / WAVELENGTH * FULL_HALF_LENGTH
    arm = np.where(np.abs(angles) < SATURATION, AMPLITUDE * k_w * np.cos(0.5 * k_w * angles), 0.0)
    return -np.sign(angles) * force * arm


def saturation(angles, rise):
    """The angle from which on the closed form of the rise, fitted to these rows, is level, over lambda / (2 w)."""
    level = rise[np.abs(angles) > 1.15 * SATURATION].mean()
    tried = np.arange(0.6, 1.6, 0.002)
    fits = [np.sum((rise - level * np.sin(0.5 * np.pi * np.minimum(np.abs(angles) / (t * SATURATION), 1.0))) ** 2) for t in tried]
    return tried[np.argmin(fits)]


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def judge(rows):
    """The five numbers of docs/explanation/experiments/fig8.md."""
    angle, rise, force, torque = rows.T
    below = (np.abs(angle) > 0.004) & (np.abs(angle) < 0.09)
    past_step = below & (np.abs(angle) > 1.25 * 1.05 / 64.0)
    wanted = torque_by_closed_form(angle, force)
    peak = PRESS_N * AMPLITUDE * 2.0 * np.pi / WAVELENGTH * FULL_HALF_LENGTH
    return {
        "rise, RMS error over 2a": rms(rise - rise_by_brute_force(angle, "largest")) / (2.0 * AMPLITUDE),
        "saturation over lambda / (2 w)": saturation(angle, rise),
        "torque against the turn, 4 to 90 mrad": np.mean((torque * angle < 0.0)[below]),
        "torque, RMS error from 20 mrad": rms((torque - wanted)[past_step]) / rms(wanted[past_step]),
        "torque in saturation": rms(torque[np.abs(angle) > 1.15 * SATURATION]) / peak,
    }


def main():
    line = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    line.add_argument("-o", "--output", default="fig8", help="folder for the tables and the block (%(default)s)")
    line.add_argument("--angles", type=int, default=113, help="from -140 to 140 mrad (%(default)s)")
    asked = line.parse_args()
    os.makedirs(asked.output, exist_ok=True)
    file = os.path.join(asked.output, "striped_block.glb")
    if not os.path.exists(file):
        full, coarse = striped_block()
        asperity.bake(full, file, name="striped_block", coarse=coarse, texture=1536)
    block = asperity.load(file)
    angles = np.linspace(-0.14, 0.14, asked.angles)
    for name, (kind, depth) in KINDS.items():
        rows = turned(block, angles, **kind)
        with open(os.path.join(asked.output, f"fig8_{name}.csv"), "w", newline="") as out:
            table = csv.writer(out)
            table.writerow(["angle_rad", "rise_m", "force_n", "torque_n_m", "rise_by_brute_force_m", "torque_by_closed_form_n_m"])
            table.writerows(np.column_stack([rows, rise_by_brute_force(angles, depth), torque_by_closed_form(angles, rows[:, 2])]).tolist())
        print(name)
        for what, number in judge(rows).items():
            print(f"  {what}: {number:.4f}")


if __name__ == "__main__":
    main()
