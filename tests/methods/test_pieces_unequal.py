"""Rods of very unequal transit times: work that grows with the ratio alone, and a
sentence.
"""

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri
from rodimpact.explorer import pieces as page
from rodimpact.explorer.design import LIBRARY, tables_of
from rodimpact.explorer.tables import request_of, system_of
from rodimpact.methods import kernels, memory
from rodimpact.methods.pieces import finality, march
from rodimpact.methods.row_builder import build_row

HERTZ = ri.Hertz(3.0)
KINDS = {  # contact laws on both sides of the short rod
    "bonded hertz": (ri.Bonded(), HERTZ),
    "hertz bonded": (HERTZ, ri.Bonded()),
    "hertz": (HERTZ, HERTZ),
    "rigid": (ri.Rigid(), ri.Rigid()),
}


def row(length, kind):
    """System of a long rod that strikes a very short one, behind which is another long
    rod; the contacts are of a kind of `KINDS`.
    """
    striker = unit_rod(1.0, velocity=1.0)
    rods = [striker, unit_rod(length), unit_rod(0.3)]
    return ri.System(rods, contacts=KINDS[kind])


@pytest.mark.parametrize("kind", few_of(KINDS, {"rigid"}))
def test_proofs_are_tried_8_times_a_second_and_not_once_each_short_transit(
    monkeypatch, kind
):
    """Each of them reads all waves under way: one in each short transit made 10 s of
    0.4 s.
    """
    n_proofs = 0
    update_groups = finality.update_groups

    def counted(*arguments):
        nonlocal n_proofs
        n_proofs += 1
        update_groups(*arguments)

    monkeypatch.setattr(finality, "update_groups", counted)
    with kernels.forced(compiling=False):
        system = row(0.01, kind)
        solution = ri.solve(system, method="characteristics")

    assert solution.final
    most_of_a_run = 8 * solution.t_end + 6  # and six at other times
    n_runs = 2  # one at rtol, and one for the stated error
    assert n_proofs <= n_runs * most_of_a_run


@pytest.mark.skipif(not kernels.enabled(), reason="a hundred thousand steps")
def test_velocities_of_a_row_with_a_ratio_of_1e4_are_right_to_the_stated_error():
    """A row with transit times of ratio 1e4 is solved by characteristics: its
    velocities differ from those by fronts by the stated error at most.
    """
    pytest.importorskip("numba")
    system = row(1e-4, "rigid")
    exact = ri.solve(system, method="fronts")

    with kernels.forced(compiling=True):
        solution = ri.solve(system, method="characteristics")

    relative_error = solution.accuracy["velocity"]
    stated = relative_error * solution.fields.clock.scale
    velocities = np.array(solution.outcome.velocities_after)
    expected = exact.outcome.velocities_after
    errors = np.abs(velocities - expected)
    assert errors.max() <= stated + 1e-13


def test_a_run_with_too_many_pieces_names_the_short_rod_if_there_is_one(monkeypatch):
    """With a small limit on memory, a row with a short rod is refused with its path and
    the advice of a rigid mass; one without a short rod with the advice of a larger
    rtol.
    """
    monkeypatch.setattr(memory, "MAX_BYTES", 3e5)
    with_short_rod = row(1e-5, "bonded hertz")
    without_short_rod = row(0.1, "hertz")

    with pytest.raises(memory.TooLong) as refusal:
        ri.solve(with_short_rod, method="characteristics")
    with pytest.raises(memory.TooLong, match="take a larger rtol"):
        ri.solve(without_short_rod, method="characteristics", until=1e3)

    problems = dict(refusal.value.problems)
    assert list(problems) == ["until"]
    sentence = problems["until"]
    assert "the transit time of bodies.1, which is 1e-05 of the longest" in sentence
    assert "replace it by a rigid mass" in sentence


def run_of_page(system, options):
    """The state, as a dict, of the run that the page makes of a system with these
    options.
    """
    case = ri.Case(system, options)
    tables = {"solve": {}} | tables_of(case)["case"]
    system_of_page = system_of(tables, LIBRARY)
    return page.run_of(
        build_row(system_of_page),
        request_of(tables),
        tolerance=1e-8,
        keep=True,
        earlier=None,
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "options", [{}, {"until": 5.0}], ids=["to the proof", "to 5 s"]
)
def test_the_page_says_that_a_row_takes_too_long_before_it_begins(
    monkeypatch, kind, options
):
    """A ratio of 1e-6 is too much work; a row with one of 0.01 is begun."""

    def begin(*_):
        raise AssertionError("the page has begun")

    monkeypatch.setattr(march, "run_nodes", begin)

    hopeless = row(1e-6, kind)
    run = run_of_page(hopeless, options)

    path = ""  # the message is about no entry of the case
    assert run["problem"] == (path, page.TOO_MUCH_WORK)
    feasible = row(0.01, kind)
    with pytest.raises(AssertionError, match="the page has begun"):
        run_of_page(feasible, options)
