"""The critical force by every method, against the accurate spectral method: a table and a figure."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import fakir

SHOWN = {
    "spectral_default": "spectral",
    "love": "boundary elements, 16 cells",
    "punch_corrected": "punch, corrected",
    "punch_plain": "punch, plain",
    "homogenised": "homogenised",
    "large_contact_corrected": "paper, many pillars",
}
fractions = [0.003, 0.01, 0.03, 0.1]
differences = {name: [] for name in SHOWN}
pillars = []
for fraction in fractions:
    system = fakir.System.from_file(
        "examples/paper-intermediate.toml", {"pattern.surface_fraction": fraction}
    )
    comparison = system.compare()
    rows = {row["method"]: row for row in map(dict, comparison.to_dict()["methods"])}
    pillars.append(rows["spectral_accurate"]["pillars_in_contact"])
    for name, found in differences.items():
        found.append(abs(rows[name]["force_difference"]))

figure, axis = plt.subplots(figsize=(6, 3.8), layout="constrained")
for name, label in SHOWN.items():
    axis.loglog(fractions, np.maximum(differences[name], 1e-9), "o-", markersize=3, label=label)
axis.set(xlabel="surface fraction", ylabel="relative difference of the critical force")
axis.legend(fontsize="small")
figure.savefig(sys.argv[1])


def shown(difference):
    return f"{100 * difference:.2g} %" if difference > 1e-3 else f"{difference:.0e}"


print("| method | " + " | ".join(f"{fraction}" for fraction in fractions) + " |")
print("|---" * (len(fractions) + 1) + "|")
for name, label in SHOWN.items():
    print(f"| {label} | " + " | ".join(map(shown, differences[name])) + " |")
print("| pillars touched | " + " | ".join(map(str, pillars)) + " |")
