"""How long it takes from moving a slider to the new contact map on the screen.

The time is that from the input event to the frame after the one in which the map is drawn, of moves
that wait for each other. It is printed; how much it may be depends on the machine, so that only
far too much fails, unless the environment variable STRICT_LATENCY is set.
"""

import os
import statistics

import pytest
from test_explorer import paper

MOVES = 25

MEASURE = """async ([moves]) => {
    const slider = document.getElementById("texture-pillar-height-slider");
    const start = Number(slider.value);
    const times = [];
    for (let move = 0; move < moves; move += 1) {
        slider.value = String(start + (move % 2 === 0 ? 1 : 0));
        const shown = new Promise((resolve) => {
            document.addEventListener("picture", (event) => {
                if (event.detail.exact) resolve();
            }, { once: false });
        });
        const begin = performance.now();
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        await shown;
        await new Promise((resolve) => requestAnimationFrame(resolve));
        times.push(performance.now() - begin);
        await new Promise((resolve) => setTimeout(resolve, 30));
        while (document.body.dataset.busy !== "no") {
            await new Promise((resolve) => setTimeout(resolve, 5));
        }
    }
    return times;
}"""


@pytest.mark.parametrize("surface_fraction, wanted", [(0.1, 50), (0.2, 400)])
def test_the_map_follows_the_slider(explore, capsys, surface_fraction, wanted):
    page = explore("#" + "&".join(paper(surface_fraction)))
    page.page.evaluate(MEASURE, [3])
    times = page.page.evaluate(MEASURE, [MOVES])
    median = statistics.median(times)
    with capsys.disabled():
        print(
            f"\nslider to map at a surface fraction of {surface_fraction}: median {median:.0f} ms, "
            f"from {min(times):.0f} to {max(times):.0f} ms, {len(times)} moves"
        )
    strict = "STRICT_LATENCY" in os.environ
    assert median < (wanted if strict else 10 * wanted)
