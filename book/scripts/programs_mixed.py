"""Tops and floor together by several programs, from the measurements in bench/results: a table in Markdown."""

import sys
from pathlib import Path

sys.path.insert(0, "bench")
from texture_rows import TRUTH, Table, points

rows = Table(Path("bench/results")).rows
print("| surface fraction | program | setting | processor time, s | error of the force, % | of the floor's share, % |")
print("|---|---|---|---|---|---|")
for fraction in [0.03, 0.1]:
    for p in points(rows, fraction, "mixed"):
        if (p.program, p.setting) == ("fakir", TRUTH):
            continue
        setting = p.setting if p.program == "fakir" else f"{p.setting}²"
        numbers = [f"{float(f'{p.processor_s:.2g}'):g}"]
        numbers += [f"{float(f'{100 * error:.2g}'):+g}" for error in (p.force_error, p.share_error)]
        print(f"| {fraction} | " + " | ".join([p.program, setting, *numbers]) + " |")
