"""Forces and spectra of arm_scrub --csv, with and without texture: plot_arm_scrub.py FORCES.csv PICTURE.png"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

table = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
names, colours = ("with texture", "without texture"), ("#c1440e", "#4a6f8a")
figure, (above, below) = plt.subplots(2, 1, figsize=(9, 6), constrained_layout=True)
for run in range(int(table["run"].max()) + 1):
    rows = table[table["run"] == run]
    time, along = rows["time_s"], rows["fy_n"]
    shown = (time >= 1.0) & (time < 2.0)
    above.plot(time[shown], along[shown], color=colours[run], lw=0.8, label=names[run])
    # The mean square in each band of the last two seconds, by windows of half a second.
    steady = along[time >= 2.0]
    window = np.hanning(512)
    pieces = [steady[i : i + 512] for i in range(0, len(steady) - 511, 256)]
    power = np.mean([np.abs(np.fft.rfft((p - p.mean()) * window)) ** 2 for p in pieces], axis=0)
    density = 2.0 * power / (1000.0 * np.sum(window**2))
    below.semilogy(np.fft.rfftfreq(512, 1e-3), np.sqrt(density), color=colours[run], lw=1.0, label=names[run])
above.set(xlabel="time (s)", ylabel="force along the scrub (N)", title="What the arm's tool feels, one scrub to and fro")
below.set(xlabel="frequency (Hz)", ylabel="force along (N / √Hz)", xlim=(0, 500))
for axes in (above, below):
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right")
figure.savefig(sys.argv[2], dpi=110)
