"""Error against processor time of several programs, from the measurements in bench/results: a figure."""

import collections
import csv
import statistics
import sys

import matplotlib.pyplot as plt

runs = collections.defaultdict(list)
with open("bench/results/texture.csv", encoding="utf-8") as table:
    for row in csv.DictReader(table):
        if row["surface_fraction"] == "0.1" and row["question"] == "transition":
            runs[row["program"], row["setting"]].append(row)
truth = float(runs["fakir", "spectral, accurate"][0]["force_N"])

programs = collections.defaultdict(list)
for (program, setting), rows in runs.items():
    if setting != "spectral, accurate":
        seconds = statistics.median(float(row["processor_s"]) for row in rows)
        error = abs(float(rows[0]["force_N"]) / truth - 1)
        name = setting.split()[0] if program == "fakir" else program
        programs[f"fakir, {name}" if program == "fakir" else name].append((seconds, error))

figure, axis = plt.subplots(figsize=(6, 3.8), layout="constrained")
for name, points in sorted(programs.items()):
    points.sort()
    axis.loglog(*zip(*points), "o-" if "fakir" in name else "s--", markersize=4, label=name)
axis.set(xlabel="processor time, s", ylabel="relative error of the critical force")
axis.legend(fontsize="small")
figure.savefig(sys.argv[1])
