"""What the runs of texture.py come to, as Markdown."""

import texture_rows
from common import PEERS

COMMAND = "python3 bench/run.py texture"
TARGETS = [1e-2, 1e-3]
HEADLINE = (0.1, "transition")
TITLES = {"transition": "critical state", "press": "pressed to {:.3g} µm"}


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
    versions = sorted({(row.program, row.version) for row in rows}, key=lambda pair: (pair[0] != "fakir", pair))
    return (
        ", ".join(f"{name} {version}" for name, version in versions)
        + f"; {days[0] if len(days) == 1 else days[0] + ' to ' + days[-1]}; "
        + f"load average of the machine {min(loads):.1f} to {max(loads):.1f}"
    )


def table(found, question):
    lines = [
        "| program | setting | error of the force | "
        + ("error of the indentation | " if question == "transition" else "")
        + "processor time, s | memory, MB | whole process, MB | solutions | runs |",
    ]
    lines.append("|" + "---|" * (lines[0].count("|") - 1))
    for p in found:
        setting = p.setting if p.program == "fakir" else f"{p.setting}²"
        truth = (p.program, p.setting) == ("fakir", texture_rows.TRUTH)
        errors = [p.force_error, p.indentation_error] if question == "transition" else [p.force_error]
        errors = ["truth" if truth else percent(error) for error in errors]
        cells = [p.program, setting, *errors, f"{p.processor_s:.3g}", number(p.memory / 1e6)]
        cells += [number(p.peak_bytes / 1e6), f"{p.solutions:.0f}" if p.solutions else "", str(p.runs)]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def ratio(found, peer, target, cost, own):
    """Cost of a peer over fakir's, or what can be said of it."""
    reached = texture_rows.at_error(found, peer, target, cost)
    if reached is not None:
        return number(reached / cost(own))
    known, errors = texture_rows.curve(found, peer)
    text = f"> {number(cost(known[-1]) / cost(own))} (not reached: {percent(errors[-1]).lstrip('+')} at {known[-1].setting}²)"
    further = texture_rows.extrapolated_cost(found, peer, target, cost)
    return text + (f"; by its order {number(further / cost(own))}" if further else "")


def headline(rows):
    found = texture_rows.points(rows, *HEADLINE)
    peers = [peer + way for way in ["", texture_rows.EXTRAPOLATED] for peer in PEERS]
    peers = [peer for peer in peers if any(p.program == peer for p in found)]
    if not peers:
        return []
    ways = [["spectral"], [setting for setting in texture_rows.FAKIR if setting != texture_rows.TRUTH]]
    lines = [
        "## Critical state at a surface fraction of 0.1, at equal error of the force",
        "",
        "Cost of a peer over that of fakir, interpolated on the peer's curve. Where a peer does not reach the error within "
        f"{texture_rows.MOST_SECONDS:.0f} s and {texture_rows.MOST_BYTES / 1e9:.0f} GB, the first number is what its finest grid takes, a lower "
        "bound; what follows *by its order* is no measurement but that curve drawn on with the slope of its last grids.",
        "",
        "| error | fakir's method | its error | its time, s | its memory, MB | peer | time ratio | memory ratio |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for target in TARGETS:
        for methods in ways:
            own = texture_rows.best_of_fakir(found, target, seconds, methods)
            if own is None:
                continue
            name = own.setting if len(methods) == 1 else f"cheapest that does: {own.setting}"
            for peer in peers:
                cells = [f"{100 * target:g} %", name, f"{own.shown_error:.1g}", f"{own.processor_s:.3g}"]
                cells += [number(own.memory / 1e6), peer]
                cells += [ratio(found, peer, target, cost, own) for cost in [seconds, memory]]
                lines.append("| " + " | ".join(cells) + " |")
    return lines


def text(rows):
    lines = ["# The paper's texture, measured", ""]
    if not rows:
        return [*lines, "Nothing yet."]
    lines += [machine(rows) + f". Command: `{COMMAND}`. What is compared, and how: [README.md](../README.md).", ""]
    lines += headline(rows)
    for question in texture_rows.QUESTIONS:
        lines += ["", f"![Error against time and memory](texture-{question}.svg)"]
        for fraction in sorted({row.surface_fraction for row in rows}):
            found = texture_rows.points(rows, fraction, question)
            if not found:
                continue
            truth = next(r for r in rows if r.what == (fraction, question, "fakir", texture_rows.TRUTH))
            title = TITLES[question].format(1e6 * texture_rows.PRESSED[fraction])
            lines += ["", f"## Surface fraction {fraction:g}, {title}", ""]
            lines += [
                f"Truth: force {1e3 * truth.force_N:.7g} mN, indentation {1e6 * truth.indentation_m:.7g} µm, "
                f"estimated error {truth.estimated_force_error:.0e}.",
                "",
            ]
            lines += table(found, question)
    return lines


def write(rows, results):
    (results / "texture.md").write_text("\n".join(text(rows)) + "\n")
