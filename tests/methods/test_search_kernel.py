"""The search for a step below the model: layouts, cuts, and sums over waves."""

import math

import numpy as np
import pytest
from networks import UNIT, unit_rod

import rodimpact as ri
from rodimpact.methods.clock import STEP_TICKS as TICKS
from rodimpact.methods.row import Row
from rodimpact.methods.steps import level_kernel as lk
from rodimpact.methods.steps import search_kernel as sk
from rodimpact.methods.steps.machine import Machine
from rodimpact.methods.steps.step_kernel import LINK, STEP


def machine(*bodies, until=None, step=1 / 16, **options):
    """The work space of a row, laid out on a step."""
    laid_out = Machine(Row(ri.System(bodies, **options)), until)
    work = laid_out.work
    work.search.at[sk.FIXED], work.level.step[0] = 1, step
    sk.prepare(work.make, work.numbers, work.search, work.level)
    lk.cut_steps(work.make, work.numbers, work.level)
    return laid_out


def ran(*bodies, **options):
    """The same after a run to the proof, or to the end that is given."""
    done = machine(*bodies, **options)
    done.search(done.work.level.step[0], 0.0)
    return done.work


def prepared(*bodies, **options):
    work = Machine(Row(ri.System(bodies, **options))).work
    return sk.prepare(work.make, work.numbers, work.search, work.level), work


# Layouts


def test_cuts_are_in_order_and_apart():
    level = machine(unit_rod()).work.level
    count = 1
    for tick in (700, 300, TICKS + 500, 3, -3, 702, TICKS - 2, 300):
        count = lk.cut_at(level, tick, count)
    assert level.places[:count] == [0, 300, 500, 700]


def test_a_transit_is_rounded_to_whole_steps_within_round_off():
    off = 0.25 + 3 / TICKS / 16
    level = machine(unit_rod(0.5), unit_rod(off), unit_rod(0.3), unit_rod(0.06)).work.level
    assert level.ticks[1:-1] == [8 * TICKS, 4 * TICKS, round(0.3 * 16 * TICKS), TICKS]
    assert level.at[lk.CUT] == 0  # not all of them are


def test_steps_are_cut_where_jumps_pass_the_ends_of_rods():
    steps = unit_rod(1.0, velocity=ri.Steps([1.0, 0.0], [0.27]))
    work = machine(steps, unit_rod(), contacts=[ri.Rigid()]).work
    cut = round(0.27 * 16 * TICKS) % TICKS
    assert work.level.places[: work.level.at[lk.PARTS] + 1] == sorted([0, cut, TICKS - cut, TICKS])


def test_impacts_have_a_short_part_of_their_own():
    masses = ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(1.0)
    law = ri.Rigid(restitution=0.5)
    level = machine(*masses, unit_rod(), contacts=[law, ri.Rigid()], gaps=[0.0, 9.0]).work.level
    assert level.places[: level.at[lk.PARTS] + 1] == [0, lk.MOMENT, TICKS]
    work = ran(*masses, unit_rod(), contacts=[law, ri.Rigid()], gaps=[0.0, 9.0], until=1.0)
    assert work.search.impulse[0] == pytest.approx(0.75)
    assert work.search.pressed[0] == 0.0
    assert math.isnan(work.search.peak[0])
    work = machine(*masses, unit_rod(), contacts=[law, ri.Rigid()], gaps=[0.2, 9.0]).work
    level = work.level
    level.closing_time[0], level.closing_link[0], level.at[lk.CLOSINGS] = 3.25 / 16, 1, 1
    lk.cut_steps(work.make, work.numbers, level)
    middle = TICKS // 4
    assert level.places[1 : level.at[lk.PARTS]] == [middle - lk.MOMENT, middle + lk.MOMENT]


def test_a_closing_replaces_the_same_one_that_was_badly_placed():
    work = machine(unit_rod(velocity=1.0), unit_rod(), gaps=[0.5]).work
    level, state, clock = work.level, work.state, work.clock
    for step, where in ((3, 0.25), (3, 0.27), (5, 0.5)):
        clock[STEP], clock[LINK], state.closed[0] = step, 1, where
        lk.note_closing(work.numbers, level, state, clock)
    assert level.at[lk.CLOSINGS] == 2
    assert level.closing_time[:2] == [3.27 / 16, 5.5 / 16]
    level.at[lk.TRIES] = lk.MOST_CUTS
    lk.note_closing(work.numbers, level, state, clock)
    assert level.at[lk.CUT] == level.at[lk.CLOSINGS] == 0


def test_there_must_be_room():
    work = machine(unit_rod(velocity=1.0), unit_rod()).work
    arguments = (work.make, work.numbers, work.limit, work.level, work.state, work.tally,
                 work.signals, work.clock)
    assert lk.lay_out(*arguments) == lk.FULL
    assert work.level.at[lk.ROOM] == lk.FIRST_ROOM * 16
    work.limit.numbers[0] = 1.0
    assert lk.lay_out(*arguments) == lk.TOO_LONG
    work.limit.numbers[0], work.level.step[0] = math.inf, 1 / 2 / lk.MOST_OF_TRANSIT
    assert lk.lay_out(*arguments) == lk.TOO_LONG
    work.level.step[0], work.limit.until[0] = 1 / 16, 1e300
    assert lk.lay_out(*arguments) == lk.TOO_LONG


def test_a_force_that_a_step_makes_vanish_is_told():
    work = ran(unit_rod(velocity=1.0), unit_rod(), contacts=[ri.Hertz(1.0)])
    work.numbers.stiffness[1] = 1e-250
    assert lk.lay_out(work.make, work.numbers, work.limit, work.level, work.state, work.tally,
                      work.signals, work.clock) == lk.VANISHED


@pytest.mark.parametrize("until", [0.5, 0.53])
def test_the_last_part_ends_where_it_was_asked_to(until):
    work = ran(unit_rod(velocity=1.0), unit_rod(), until=until)
    level = work.level
    assert level.at[lk.REASON] == lk.UNTIL
    assert level.at[lk.TAKEN] == math.ceil(until * 16)
    assert level.edges[level.at[lk.TAKEN]] == round(until * 16 * TICKS)
    assert work.search.impulse[0] == pytest.approx(until / 2, rel=1e-12)  # F = 1/2 to t = 2


def test_a_last_part_leaves_the_steps_as_they_were():
    work = ran(unit_rod(0.7, velocity=1.0), unit_rod(), until=0.53)
    assert work.state.part[0] == 1.0
    assert work.state.share[1] == pytest.approx(0.7 * 16 % 1)


def test_a_run_ends_with_its_proof():
    at = ran(unit_rod(velocity=1.0), unit_rod()).level.at
    assert (at[lk.REASON], at[lk.TAKEN]) == (lk.FINAL, at[lk.PROOF] + 1)
    at = ran(unit_rod(velocity=1.0), unit_rod(), until=5.0).level.at
    assert (at[lk.REASON], at[lk.PROOF]) == (lk.UNTIL, 5 * 16)


def test_a_moved_end_under_gravity_pushes_a_rod():
    work = ran(unit_rod(velocity=1.0), ends=(ri.Moved(1.0), ri.Free()), gravity=-2.0, until=0.5)
    assert work.search.after[0] == pytest.approx(1 - 2 * 0.5 + 0.5**2, abs=1e-12)  # F = 2 t
    assert work.level.at[lk.PROOF] == -1


def test_what_an_endless_bar_brings_is_what_it_was():
    work = ran(unit_rod(velocity=1.0), ends=(ri.Absorbing(), ri.Free()), until=3.0)
    assert work.search.after[0] == pytest.approx(1.0, abs=1e-12)
    assert work.state.mobility[0] == 1.0
    work = ran(unit_rod(velocity=3.0), unit_rod(velocity=1.0), ends=(ri.Free(), ri.Absorbing()),
               contacts=[ri.Bonded()], until=8.0)
    assert work.search.after[0] == pytest.approx(1.0, abs=1e-12)


# The search


def test_the_first_step_divides_all_transits():
    flag, work = prepared(unit_rod(0.25), unit_rod(1.0), unit_rod(0.75))
    at = work.search.at
    assert (flag, at[sk.FITS], at[sk.NUMBER]) == (sk.DONE, 1, sk.FIRST)
    assert at[sk.MOST_FACTOR] == 2 * sk.MOST_DIVIDED // sk.FIRST
    _, work = prepared(unit_rod(0.001), unit_rod(1.0))
    assert work.search.at[sk.NUMBER] == sk.SHORTEST * 1000
    _, work = prepared(unit_rod(math.sqrt(0.5)), unit_rod(1.0))
    assert work.search.at[sk.FITS] == work.level.at[lk.CUT] == 0
    assert work.search.at[sk.MOST_FACTOR] == 2 * sk.ROUGHEST // sk.FIRST
    flag, _ = prepared(unit_rod(1e-6), unit_rod(1.0))
    assert flag == sk.TOO_SHORT


def test_levels_follow_each_other_to_the_last():
    _, work = prepared(unit_rod(), unit_rod(0.5))
    sizes = []
    while sk.choose_level(work.make, work.numbers, work.search, work.level):
        sizes.append(round(1 / (sk.FIRST * work.level.step[0])))
    assert sizes[:7] == [1, 2, 3, 4, 6, 8, 12]
    assert sizes[-1] == 512
    _, work = prepared(unit_rod(), unit_rod(math.sqrt(0.5)))
    work.level.at[lk.TRIES] = 9
    sk.choose_level(work.make, work.numbers, work.search, work.level)
    assert sk.FIRST < 1 / work.level.step[0] < 4 * sk.FIRST // 3  # where waves fit best
    assert work.level.at[lk.TRIES] == 0
    work.search.at[sk.LEVELS] = sk.MOST_LEVELS
    assert not sk.choose_level(work.make, work.numbers, work.search, work.level)


def test_graded_parts_grow_from_a_cut_and_are_divided_from_level_to_level():
    _, work = prepared(ri.RigidMass(1.0, velocity=1.0), unit_rod(0.5), unit_rod(0.75),
                       contacts=[ri.Spring(1e4), ri.Rigid()], gaps=[0.0, 0.1])
    level = work.level
    assert level.at[lk.CUT] == level.at[lk.FACTOR] == 1
    level.closing_time[0], level.closing_link[0], level.at[lk.CLOSINGS] = 0.6, 2, 1
    level.places.extend([0] * 2000)  # the least room is not enough
    found = []
    for factor in (1, 2):
        assert sk.choose_level(work.make, work.numbers, work.search, level)
        assert level.at[lk.FACTOR] == factor
        lk.cut_steps(work.make, work.numbers, level)
        found.append(np.array(level.places[: level.at[lk.PARTS] + 1]) * level.step[0] / TICKS)
    coarse, fine = found
    assert coarse[-1] == pytest.approx(0.25)  # of which both transits are whole numbers
    cut = np.argmin(abs(coarse - 0.1))
    assert coarse[cut] == pytest.approx(0.1)  # 0.6, two periods later
    assert fine[::2] == pytest.approx(coarse, abs=1e-12)
    for begin, end in ((0, cut), (cut, len(coarse) - 1)):
        widths = np.diff(coarse[begin : end + 1])
        behind = coarse[begin:end] - coarse[begin] + 1e-4
        even = lk.WIDEST * level.step[0] * 2
        assert np.all(widths <= 1.001 * np.minimum(even, 1.05 * lk.GROWTH * behind))
        assert widths[0] == pytest.approx(lk.GROWTH * 1e-4, rel=0.05)


def test_levels_that_cannot_be_accurate_are_left_out():
    _, work = prepared(unit_rod(), unit_rod())
    search = work.search
    search.at[sk.RUNG], search.goal[0] = 4, 1e-5  # the factor was 4
    search.estimates[:] = [1e-5, 2.5e-5, 0.0, 0.0, 9.0, 0.0]
    sk.leave_out(search)
    assert sk.factor_of(search.at[sk.RUNG]) == 8  # 4 sqrt(2.5) and no less
    search.at[sk.RUNG], search.estimates[0] = 4, math.inf
    sk.leave_out(search)
    assert search.at[sk.RUNG] == 4


def test_what_hangs_on_places_inside_steps_is_not_smooth():
    _, work = prepared(unit_rod(velocity=1.0), unit_rod())
    search, level = work.search, work.level
    assert sk.is_smooth(work.make, search, level)
    level.at[lk.CLOSINGS] = 1
    assert not sk.is_smooth(work.make, search, level)
    level.at[lk.CLOSINGS], search.at[sk.FITS] = 0, 0
    assert not sk.is_smooth(work.make, search, level)


def test_all_but_the_duration_must_come_to_the_goal():
    _, work = prepared(unit_rod(), unit_rod())
    search = work.search
    search.goal[0] = 1e-5
    search.estimates[:] = [1e-5] * 4 + [1.0, 0.0]
    assert sk.is_met(search)
    for name in range(sk.DURATION):
        search.estimates[name] = 1.1e-5
        assert not sk.is_met(search)
        search.estimates[name] = 1e-5


def test_the_level_before_is_run_again_with_its_closings():
    _, work = prepared(unit_rod(), unit_rod())
    search, level = work.search, work.level
    search.at[sk.LEVELS], search.sizes[:2] = 2, [0.5, 0.25]
    level.at[lk.KEPT], level.kept_time[0], level.kept_link[0] = 1, 0.7, 1
    sk.repeat_last(search, level)
    assert (level.step[0], search.at[sk.FIXED], level.at[lk.CUT]) == (0.25, 1, 1)
    assert (level.at[lk.CLOSINGS], level.closing_time[0], level.closing_link[0]) == (1, 0.7, 1)
    level.at[lk.KEPT] = -1
    sk.repeat_last(search, level)
    assert level.at[lk.CUT] == level.at[lk.CLOSINGS] == 0


# Sums over waves

STRIKER = ri.Rod(0.5, area=2.0, material=UNIT, velocity=3.0)


@pytest.mark.parametrize("gravity", [0.0, -2.0])
def test_before_and_after_two_rods_with_a_mass_on_one(gravity):
    bodies = (ri.RigidMass(0.5, velocity=3.0), STRIKER, unit_rod())
    work = ran(*bodies, contacts=[ri.Bonded(), ri.Rigid()], gravity=gravity, until=0.4)
    search = work.search
    assert search.before == pytest.approx([3.0, 0.0], abs=1e-12)
    push = search.impulse[0]
    assert push == pytest.approx(0.4 * 3 * 2 / 3, rel=1e-12)  # until waves come back: Z1 Z2/(Z1+Z2)
    assert search.mass == pytest.approx([1.5, 1.0])
    after = np.array([3.0 - push / 1.5, push]) + gravity * 0.4
    assert search.after == pytest.approx(after, abs=1e-12)
    kinetic = sum(m * v * v / 2 for m, v in zip((1.5, 1.0), after - gravity * 0.4, strict=True))
    assert sum(search.vibration) == pytest.approx(1.5 * 9 / 2 - kinetic, abs=1e-12)


def test_vibration_is_that_of_each_body():
    work = ran(unit_rod(1.0, 2.0, strain=0.25), unit_rod(velocity=5.0), gaps=[100.0], until=0.0625)
    assert work.search.vibration == pytest.approx([2 * 0.25**2 / 2, 0.0], abs=1e-12)


def test_energy_is_lost_where_delays_are_means_of_two_averages():
    """Of that which is there in the frame of the row, at the mean of both velocities."""
    for length, gap in ((math.sqrt(0.5), 0.0), (math.sqrt(0.5), 0.21), (0.5, 0.0)):
        striker = ri.Rod(length, area=1.0, material=UNIT, velocity=1.0)
        work = ran(striker, unit_rod(), until=3.0, gaps=[gap])
        lost = sk.energy_lost(*work[:2], work.level, work.state, work.tally, work.signals)
        left = sum(work.search.vibration) + sum(
            m * v * v / 2 for m, v in zip(work.search.mass, work.search.after, strict=True)
        )
        there = (length + 1) / 8
        assert lost == pytest.approx((length / 2 - left) / there, abs=1e-12)
        assert (lost > 1e-3) == (length != 0.5)


def test_totals_are_carried_on_only_where_estimates_say_so():
    row = Row(ri.System([unit_rod(0.4, velocity=1.0), unit_rod()], contacts=[ri.Hertz(50.0)]))
    work = Machine(row)
    work.search(None, 1e-5)
    search, last = work.work.search, sk.width_of_measures(work.work.make)
    n = search.at[sk.LEVELS]
    measured = search.values[(n - 1) * last : n * last]
    assert search.at[sk.PEAKS_CARRIED] == search.at[sk.TIMES_CARRIED] == 1
    fine = Machine(row)
    fine.search(search.sizes[n - 1] / 32, 0.0)
    for found, own, exact in (
        (search.peak[0], measured[-3], fine.work.search.peak[0]),
        (search.pressed[0], measured[-1], fine.work.search.pressed[0]),
    ):
        assert abs(found - exact) < abs(own - exact) / 2
    assert work.work.level.at[lk.CLOSINGS] == 0
    assert search.at[sk.RUNG] >= n
    levels, scale = (search.values, last, search.sizes, n), row.scale
    assert measured[2] == pytest.approx(measured[1] - measured[0])
    assert search.estimates[sk.VELOCITY] == sk.SURE * sk.error_of(*levels, 0, 3, True, scale)
    assert search.estimates[sk.DURATION] == sk.carried_error(*levels, last - 1, last)


def test_estimates_are_no_less_than_the_energy_that_is_lost():
    work = Machine(Row(ri.System([unit_rod(math.sqrt(0.5), velocity=1.0), unit_rod()], [0.21])))
    work.search(None, 0.02)
    *measures, lost = work.work.search.estimates
    assert min(measures) >= lost > 0


def test_results_stand_in_the_rows_of_their_member():
    work = ran(STRIKER, unit_rod(), unit_rod(velocity=-1.0))
    width = (2, 2, 3, 3, 3, 3, 2, 2, 2, 2)
    results = sk.Results(*([-1.0] * (3 * n) for n in (1, 1, 1, 3, 3, 3, 2, 2, 2, 2)))
    sk.enter(work.make, work.search, work.level, work.tally, results, 1)
    assert len(width) == len(results)
    assert results.after == [-1.0] * 3 + list(work.search.after) + [-1.0] * 3
    assert results.impulse == [-1.0] * 2 + list(work.search.impulse) + [-1.0] * 2
    assert results.peak == [-1.0] * 2 + list(work.search.peak) + [-1.0] * 2
    assert results.pressed[2:4] == list(work.search.pressed)
    assert results.episodes[2:4] == [work.tally.episodes[i] for i in work.make.opening]
    assert results.episodes[2:4] == [1, 1]
    assert results.final == [-1.0, 1, -1.0]
