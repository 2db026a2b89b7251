"""One placing of a row, for figures, films and the page alike."""

import re
from fractions import Fraction

import numpy as np
import pytest
from drawing import rod
from exhaustive import few_of

import rodimpact as ri
from rodimpact import plot
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import scene_of
from rodimpact.plot.layout import choose_layout
from rodimpact.results.magnification import PICTURED_MOVEMENT

ROWS = {
    **{preset.key: (preset.case.system, {}) for preset in presets()},
    "drifting": (ri.System([rod(0.4, 101.0), rod(1.0, 100.0)]), {}),
    "gap": (ri.System([rod(0.4, 1.0).replace(strain=1e-4), rod()], gaps=[1e-4]), {}),
    "struck wall": (ri.System([rod(0.4), ri.Wall(-1.0)]), {}),
    "masses": (
        ri.System(
            [ri.RigidMass(0.1, velocity=2.0), rod(0.4), ri.RigidMass(0.2)],
            contacts=[ri.Hertz(1e10), ri.Rigid()],
        ),
        {"until": 3e-4},
    ),
    "driven": (
        ri.System([rod(0.4)], ends=(ri.Moved(1.0), ri.Fixed())),
        {"until": 2e-4, "method": "characteristics"},
    ),
}


USUAL = {"drifting", "gap", "masses", "driven"}


@pytest.fixture(scope="module", params=few_of(ROWS, USUAL))
def solution(request):
    system, how = ROWS[request.param]
    return ri.solve(system, **how)


@pytest.fixture
def row(solution):
    """How the page lays out the row."""
    asked = {"until": solution.t_end, "method": solution.method}
    sent = tables_of(with_gauges(ri.Case(solution.system, asked)))
    return scene_of(sent["case"], sent["gauges"], LIBRARY)["row"]


def test_figures_film_and_page_magnify_by_the_same_factor_in_the_same_frame(
    solution, row
):
    plan = choose_layout(solution, 0.0, solution.t_end)
    assert row["magnification"] == plan.magnification
    assert row["frame"] == plan.frame
    assert plan.block in (0, row["block"])
    assert plan.scale in row["note"]
    snapshots = plot.snapshots(solution, times=[0.0, solution.t_end]).ax
    for ax in (plot.spacetime(solution, coordinates="lab").ax, snapshots):
        label = " ".join(ax.get_xlabel().split())
        assert plan.scale in label
        assert (
            ("in a frame moving" in label)
            == (plan.frame != 0)
            == ("frame" in row["note"])
        )
    film = plot.animation(solution, frames=2).figure.axes[0]
    assert plan.scale in " ".join(film.get_xlabel().split())


def test_the_page_and_the_figures_draw_bodies_at_the_same_places(solution, row):
    plan = choose_layout(solution, 0.0, solution.t_end)
    for t in np.linspace(0.0, solution.t_end, 5):
        for i in range(len(solution.system.bodies)):
            u = float(solution.displacement(i, 0.0, t))
            left = plan.left[i] + row["magnification"] * (
                row["apart"][i] + u - row["frame"] * t
            )
            assert left == pytest.approx(
                float(plan.end(i, False, t)), abs=1e-6 * plan.row
            )


def test_magnification_is_round_and_moves_bodies_no_farther_than_a_part_of_the_row(
    solution,
):
    plan = choose_layout(solution, 0.0, solution.t_end)
    assert re.fullmatch(r"[125]0*", f"{plan.magnification:g}")
    total = sum(
        plan.widths[i]
        for i, body in enumerate(solution.system.bodies)
        if isinstance(body, ri.Rod)
    )
    times = np.linspace(0.0, solution.t_end, 101)
    ends = np.array(
        [
            plan.end(i, right, times) - plan.left[i] - right * plan.widths[i]
            for i in range(len(solution.system.bodies))
            for right in (False, True)
        ]
    )
    assert np.ptp(ends) <= PICTURED_MOVEMENT * total * (1 + 1e-9)


def test_a_magnification_of_any_kind_of_number_is_a_float(solution):
    plan = choose_layout(solution, 0.0, solution.t_end, Fraction(1, 4))
    assert plan.magnification.hex() == (0.25).hex()
    assert plan.scale.endswith("0.25")


def test_walls_are_walls_and_fixed_ends_by_the_side_they_bound():
    held = ri.System(
        [ri.Wall(), rod(0.4, 1.0)], gaps=[1e-4], ends=(ri.Free(), ri.Fixed())
    )
    assert choose_layout(ri.solve(held, until=1e-4), 0.0, 1e-4).walls() == [
        (0, False),
        (1, True),
    ]
