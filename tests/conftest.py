"""Processor time of every test, so that slow ones can be marked: printed at the end of a run."""

import pytest

try:
    import resource
except ImportError:  # Windows
    resource = None

# Seconds of processor time above which a test belongs to the second tier.
LIMIT = 2.0

STARTED = pytest.StashKey()


def used():
    """Processor time of this process and of the children that have ended, s."""
    if resource is None:
        return 0.0
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    item.stash[STARTED] = used()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if report.when == "teardown":
        report.user_properties.append(("processor_s", used() - item.stash.get(STARTED, used())))
    return report


def pytest_terminal_summary(terminalreporter):
    """Lists tests of the first tier above the limit; with `-v` every test, slowest first."""
    rows = []
    for reports in terminalreporter.stats.values():
        for report in reports:
            if getattr(report, "when", None) == "teardown":
                rows += [(time, report) for name, time in report.user_properties if name == "processor_s"]
    rows.sort(key=lambda row: -row[0])
    verbose = terminalreporter.verbosity > 0
    shown = [row for row in rows if verbose or (row[0] > LIMIT and not {"slow", "smoke"} & set(row[1].keywords))]
    if shown:
        terminalreporter.section("processor time" if verbose else f"more than {LIMIT:.0f} s of processor time")
    for time, report in shown:
        terminalreporter.write_line(f"{time:8.2f} s  {report.nodeid}")
