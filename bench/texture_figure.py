"""Figures of error against processor time and memory, from the table of texture.py.

    python texture_figure.py FOLDER

Runs in the environment that run.py makes.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
import texture_rows

COLOURS = {"ContactMechanics": "#c1572b", "Tamaas": "#2d6a9f"}
FAKIR = {
    "spectral": ("#111111", "*", "fakir, spectral"),
    "punch": ("#111111", "D", "fakir, punch"),
    "homogenised": ("#111111", "s", "fakir, homogenised"),
}
NAMES = {
    "transition": "critical force",
    "press": "force at an indentation",
    "mixed": "force past the transition",
}


def draw(axes, found, cost):
    for program, colour in COLOURS.items():
        for way, style in [("", "o-"), (texture_rows.EXTRAPOLATED, "o:")]:
            known = sorted((p for p in found if p.program == program + way), key=lambda p: int(p.setting))
            face = colour if not way else "white"
            axes.loglog([cost(p) for p in known], [p.shown_error for p in known], style, color=colour,
                        mfc=face, ms=4.5, lw=1.2, label=program + (", extrapolated" if way else ""))
    for setting, (colour, marker, label) in FAKIR.items():
        known = [p for p in found if (p.program, p.setting) == ("fakir", setting)]
        if not known:
            continue
        axes.loglog([cost(p) for p in known], [p.shown_error for p in known], marker, color=colour,
                    ms=9 if marker == "*" else 5, ls="none", label=label)
    love = [p for p in found if p.program == "fakir" and p.setting.startswith("love")]
    if love:
        axes.loglog([cost(p) for p in love], [p.shown_error for p in love], "^-", color="#5a8f3d", ms=5, lw=1.2,
                    label="fakir, boundary elements: 8, 16, 32 cells\nacross a pillar")
    for error in [1e-2, 1e-3]:
        axes.axhline(error, color="0.75", lw=0.8, zorder=0)
    axes.grid(True, which="major", color="0.92", lw=0.6)
    axes.set_axisbelow(True)


def figure(rows, question, results):
    rows = [row for row in rows if row.question == question]
    if not rows:
        return
    fractions = sorted({row.surface_fraction for row in rows})
    size = (9.2, 0.9 + 2.9 * len(fractions))
    picture, grid = plt.subplots(len(fractions), 2, figsize=size, squeeze=False, sharex="col", layout="constrained")
    for fraction, (left, right) in zip(fractions, grid):
        found = texture_rows.points(rows, fraction, question)
        draw(left, found, lambda p: p.processor_s)
        draw(right, found, lambda p: p.memory / 1e6)
        left.set_ylabel(f"error of the {NAMES[question]}")
        left.set_title(f"surface fraction {fraction:g}", loc="left", fontsize=10)
        right.sharey(left)
        right.tick_params(labelleft=False)
    grid[-1][0].set_xlabel("processor time (s)")
    grid[-1][1].set_xlabel("memory (MB)")
    handles, labels = grid[0][0].get_legend_handles_labels()
    picture.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    loads = [row.load_average for row in rows]
    versions = sorted({(row.program, row.version) for row in rows}, key=lambda pair: (pair[0] != "fakir", pair))
    note = ", ".join(f"{name} {version}" for name, version in versions)
    note += f"; {common.processor()}, load average {min(loads):.1f} to {max(loads):.1f}, {max(row.date for row in rows)[:10]}"
    picture.suptitle(note, fontsize=7, color="0.35", x=0.01, ha="left")
    for kind in ["svg", "png"]:
        settings = {"metadata": {"Date": None}} if kind == "svg" else {"dpi": 200}
        picture.savefig(results / f"texture-{question}.{kind}", **settings)


def main():
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "fakir", "axes.spines.top": False, "axes.spines.right": False})
    results = Path(sys.argv[1])
    for question in texture_rows.QUESTIONS:
        figure(texture_rows.Table(results).rows, question, results)


if __name__ == "__main__":
    main()
