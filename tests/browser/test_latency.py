"""Time from the motion of a slider to the new contact map on the screen.

With many pillars the map is drawn three times: as an estimate from the homogenised lattice, then with
every pillar from the punch lattice, whose forces are accurate to one per cent, and then exact. Past the transition
the pillar tops alone are drawn before the exact map, which includes the floor.

The time is measured from the input event until the frame with the new map has been drawn; each motion starts
after the map of the previous one. It is printed. As it depends on the machine, the test fails only
at ten times the target, unless the environment variable STRICT_LATENCY is set.
"""

import os
import statistics

import pytest
from test_explorer import paper

MOVES = 25

MEASURE = """async ([moves]) => {
    const slider = document.getElementById("pattern-pillar-height-slider");
    const start = Number(slider.value);
    const times = { estimate: [], pillars: [], exact: [] };
    for (let move = 0; move < moves; move += 1) {
        slider.value = String(start + (move % 2 === 0 ? 1 : 0));
        const begin = performance.now();
        await new Promise((resolve) => {
            const listen = (event) => {
                const { stage, asked } = event.detail;
                // The map of the previous motion may be drawn again.
                if (asked < begin) return;
                times[stage].push(performance.now() - begin);
                if (stage !== "exact") return;
                document.removeEventListener("picture", listen);
                resolve();
            };
            document.addEventListener("picture", listen);
            slider.dispatchEvent(new Event("input", { bubbles: true }));
        });
        while (document.body.dataset.busy !== "no") {
            await new Promise((resolve) => setTimeout(resolve, 5));
        }
        await new Promise((resolve) => setTimeout(resolve, 30));
    }
    return times;
}"""


@pytest.mark.parametrize("surface_fraction, required", [(0.1, 50), (0.2, 400)])
def test_the_map_follows_the_slider(explore, capsys, surface_fraction, required):
    page = explore("#" + "&".join(paper(surface_fraction)))
    median = measured(page, capsys, f"at a surface fraction of {surface_fraction}")
    assert median["exact"] < allowed(required)


@pytest.mark.parametrize("surface_fraction, required", [(0.03, 100), (0.1, 600)])
def test_the_map_follows_the_slider_in_mixed_contact(explore, capsys, surface_fraction, required):
    """Halfway again past the transition: pillar tops and floor."""
    page = explore("#" + "&".join([*paper(surface_fraction), "load=1.5"]))
    median = measured(page, capsys, f"past the transition, at a surface fraction of {surface_fraction}")
    assert median["exact"] < allowed(required)


def measured(page, capsys, where):
    """Median times, ms, until the map of every stage."""
    page.page.evaluate(MEASURE, [3])
    times = page.page.evaluate(MEASURE, [MOVES])
    median = {stage: statistics.median(of) for stage, of in times.items() if of}
    words = ", ".join(f"{stage} {time:.0f} ms" for stage, time in median.items())
    with capsys.disabled():
        print(f"\nslider to map {where}: median {words}")
    return median


def allowed(required):
    return required if "STRICT_LATENCY" in os.environ else 10 * required
