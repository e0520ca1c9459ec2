"""What the runs of texture.py come to, as Markdown."""

import texture_rows
from common import PEERS

COMMAND = "python3 bench/run.py texture"
# What is compared at equal error: surface fraction, question, quantity, errors.
HEADLINES = [
    (0.1, "transition", "force", [1e-2, 1e-3]),
    (0.03, "mixed", "force", [1e-2, 1e-3]),
    (0.03, "mixed", "fraction of the load on the floor", [1e-1, 1e-2]),
    (0.1, "mixed", "force", [1e-2, 1e-3]),
    (0.1, "mixed", "fraction of the load on the floor", [1e-1, 1e-2]),
]
TITLES = {
    "transition": "critical state",
    "press": "pressed to {:.3g} µm",
    "mixed": "tops and floor, pressed to {:.3g} µm",
}


def seconds(point):
    return point.processor_s


def memory(point):
    return point.memory


def number(value):
    """Three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):,.10g}" if value < 1e7 else f"{value:.1e}"


def percent(error, resolution=0.0):
    if abs(error) < resolution:
        return f"< {100 * resolution:.0e} %"
    return f"{100 * error:+.2g} %" if abs(error) < 0.0995 else f"{100 * error:+.0f} %"


def machine(rows):
    loads = [row.load_average for row in rows]
    days = sorted({row.date[:10] for row in rows})
    processors = sorted({row.processor for row in rows} - {""})
    versions = sorted({(row.program, row.version) for row in rows}, key=lambda pair: (pair[0] != "fakir", pair))
    return (
        ", ".join(f"{name} {version}" for name, version in versions)
        + f"; {days[0] if len(days) == 1 else days[0] + ' to ' + days[-1]}; "
        + "".join(f"{processor}; " for processor in processors)
        + f"load average {min(loads):.1f} to {max(loads):.1f}"
    )


def table(found, question):
    lines = [
        "| program | setting | error of the force | "
        + {"transition": "error of the indentation | ", "press": "", "mixed": "error of the floor's share | "}[question]
        + "processor time, s | memory, MB | whole process, MB | solutions | runs |",
    ]
    lines.append("|" + "---|" * (lines[0].count("|") - 1))
    for p in found:
        setting = p.setting if p.program == "fakir" else f"{p.setting}²"
        truth = (p.program, p.setting) == ("fakir", texture_rows.TRUTH)
        second = {"transition": [p.indentation_error], "press": [], "mixed": [p.share_error]}[question]
        errors = [p.force_error, *second]
        errors = ["truth" if truth else percent(error) for error in errors]
        cells = [p.program, setting, *errors, f"{p.processor_s:.3g}", number(p.memory / 1e6)]
        cells += [number(p.peak_bytes / 1e6), f"{p.solutions:.0f}" if p.solutions else "", str(p.runs)]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def costs(found, peer, target, cost):
    """Cost of a peer, whether that is but a lower bound, and where it does not get further."""
    reached = texture_rows.at_error(found, peer, target, cost)
    if reached is not None:
        return reached, False
    known, _ = texture_rows.curve(found, peer)
    return cost(known[-1]), True


def title(fraction, question):
    pressed = texture_rows.INDENTATIONS.get(question, {}).get(fraction, 0.0)
    return TITLES[question].format(1e6 * pressed)


def headline(rows, fraction, question, quantity, targets):
    found = texture_rows.points(rows, fraction, question)
    if quantity != "force":
        found = [p.of_share for p in found]
    peers = [peer + way for way in ["", texture_rows.EXTRAPOLATED] for peer in PEERS]
    peers = [peer for peer in peers if any(p.program == peer for p in found)]
    if not peers:
        return []
    lines = [
        f"## Surface fraction {fraction:g}, {title(fraction, question)}, at equal error of the {quantity}",
        "",
        "Processor time and memory that a peer takes to an error, interpolated on its curve, and over those of fakir. Where a peer "
        f"does not reach the error within {texture_rows.MOST_SECONDS:.0f} s and {texture_rows.MOST_BYTES / 1e9:.0f} GB, the cost of its finest grid "
        "is a lower bound, marked `>`. *By its order* is no measurement: its curve drawn on with the order that its last grids show, "
        "where that is near the first.",
    ]
    others = [setting for setting in texture_rows.FAKIR if setting != texture_rows.TRUTH]
    for target in targets:
        own = [texture_rows.best_of_fakir(found, target, seconds, methods) for methods in [["spectral"], others]]
        # The same one may be both.
        own = [p for place, p in enumerate(own) if p and p not in own[:place]]
        lines += ["", f"### To {100 * target:g} %", ""]
        lines += [
            f"* fakir, {p.setting}: error {p.shown_error:.1g}, {p.processor_s:.3g} s, {number(p.memory / 1e6)} MB."
            + ("" if p is own[0] else " The cheapest of its methods that does.")
            for p in own
        ]
        names = [p.setting for p in own]
        lines += ["", "| peer | finest grid, error | time, s | memory, MB | " + " | ".join(f"time over {n}'s | memory over {n}'s" for n in names)
                  + " | by its order, not measured: time, s; memory, MB |"]
        lines.append("|" + "---|" * (lines[-1].count("|") - 1))
        lines += [peer_line(found, peer, target, own) for peer in peers]
    return [*lines, ""]


def peer_line(found, peer, target, own):
    known, errors = texture_rows.curve(found, peer)
    cells = [peer, f"{known[-1].setting}², {percent(errors[-1]).lstrip('+')}"]
    time, bound = costs(found, peer, target, seconds)
    size, _ = costs(found, peer, target, memory)
    mark = "> " if bound else ""
    cells += [mark + number(time), mark + number(size / 1e6)]
    for p in own:
        cells += [mark + number(time / p.processor_s), mark + number(size / p.memory)]
    further = [texture_rows.extrapolated_cost(found, peer, target, cost) for cost in [seconds, memory]]
    cells.append(f"{number(further[0])}; {number(further[1] / 1e6)}" if bound and all(further) else "")
    return "| " + " | ".join(cells) + " |"


def text(rows):
    lines = ["# The paper's texture, measured", ""]
    if not rows:
        return [*lines, "Nothing yet."]
    lines += [machine(rows) + f". Command: `{COMMAND}`. What is compared, and how: [README.md](../README.md).", ""]
    for what in HEADLINES:
        lines += headline(rows, *what)
    lines.pop()
    for question in texture_rows.QUESTIONS:
        lines += ["", f"![Error against time and memory](texture-{question}.svg)"]
        for fraction in sorted({row.surface_fraction for row in rows}):
            found = texture_rows.points(rows, fraction, question)
            if not found:
                continue
            truth = next(r for r in rows if r.what == (fraction, question, "fakir", texture_rows.TRUTH))
            lines += ["", f"## Surface fraction {fraction:g}, {title(fraction, question)}", ""]
            lines += [
                f"Truth: force {1e3 * truth.force_N:.7g} mN, indentation {1e6 * truth.indentation_m:.7g} µm, "
                f"estimated error {truth.estimated_force_error:.0e}."
                + (
                    f" The floor carries {truth.floor_share:.6g} of it, estimated error {truth.estimated_share_error:.0e}."
                    if truth.floor_share
                    else ""
                ),
                "",
            ]
            lines += table(found, question)
    return lines


def write(rows, results):
    (results / "texture.md").write_text("\n".join(text(rows)) + "\n")
