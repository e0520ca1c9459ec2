"""fakir against a table of critical states on which independent solvers agree; a figure of the differences."""

import csv
import sys

import matplotlib.pyplot as plt

import fakir

differences = {"default": [], "accurate": []}
fractions, allowed = [], []
with open("crates/fakir/tests/reference/critical_states.csv", encoding="utf-8") as table:
    for row in csv.DictReader(table):
        known = float(row["critical_force_N"])
        if known == 0:
            continue
        system = fakir.System.from_file(
            "examples/paper-intermediate.toml",
            {
                "pattern.surface_fraction": float(row["surface_fraction"]),
                "pattern.offset": float(row["offset"]),
                "pattern.pillar.compliance": row["compliance"],
                "substrate.young_modulus": float(row["substrate_young_modulus_Pa"]),
            },
        )
        fractions.append(float(row["surface_fraction"]))
        allowed.append(max(float(row["force_relative_error"]), 1e-9))
        for accuracy, found in differences.items():
            state = system.transition(accuracy=accuracy)
            difference = abs(state.force / known - 1)
            assert difference <= state.error.force + allowed[-1], (row, difference)
            found.append(max(difference, 1e-9))

figure, axis = plt.subplots(figsize=(6, 3.5), layout="constrained")
axis.loglog(fractions, allowed, "k_", markersize=9, label="error of the table")
axis.loglog(fractions, differences["default"], "o", color="tab:orange", label="default accuracy")
axis.loglog(fractions, differences["accurate"], ".", color="tab:blue", label="accurate")
axis.set(xlabel="surface fraction", ylabel="relative difference of the critical force")
axis.legend()
figure.savefig(sys.argv[1])
print(f"{len(fractions)} critical states: every difference is within the two estimated errors.")
for accuracy, found in differences.items():
    print(f"Largest relative difference, {accuracy}: {max(found):.0e}")
