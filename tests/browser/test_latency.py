"""Time from the motion of a slider to the new contact map on the screen.

With many pillars the map is drawn three times: as an estimate from the homogenised lattice, then with
every pillar from the punch lattice, whose forces are accurate to one per cent, and then exact. Past the transition
the pillar tops alone are drawn before the exact map, which includes the floor.

The time is measured from the input event until the frame with the new map has been drawn; each motion starts
after the map of the previous one. As it depends on the machine, and on what else it does, the measurements (`latency`) belong to no tier of the
checks: `cargo xtask latency` runs them. That every motion ends with the exact map is a test of the second tier.
"""

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


@pytest.mark.parametrize("surface_fraction, load", [(0.1, 1), (0.03, 1.5)])
def test_every_motion_ends_with_the_exact_map(explore, surface_fraction, load):
    """Past the transition the pillar tops alone are drawn first; a critical state may be exact before an estimate is drawn.

    On a busy machine the exact map of a single motion may arrive first as well.
    """
    page = explore("#" + "&".join([*paper(surface_fraction), f"load={load}"]))
    moves = 2 if load <= 1 else 8
    times = page.page.evaluate(MEASURE, [moves])
    assert len(times["exact"]) == moves
    if load > 1:
        assert times["pillars"] and min(times["pillars"]) < max(times["exact"])


@pytest.mark.latency
@pytest.mark.parametrize("surface_fraction, load, required", [(0.1, 1, 50), (0.2, 1, 400), (0.03, 1.5, 100), (0.1, 1.5, 600)])
def test_the_map_follows_the_slider(explore, capsys, surface_fraction, load, required):
    """At a load of 1.5, halfway again past the transition, with pillar tops and floor."""
    page = explore("#" + "&".join([*paper(surface_fraction), f"load={load}"]))
    page.page.evaluate(MEASURE, [3])
    times = page.page.evaluate(MEASURE, [MOVES])
    median = {stage: statistics.median(of) for stage, of in times.items() if of}
    words = ", ".join(f"{stage} {time:.0f} ms" for stage, time in median.items())
    with capsys.disabled():
        print(f"\nslider to map at a surface fraction of {surface_fraction}, load {load}: median {words}")
    assert median["exact"] < required
