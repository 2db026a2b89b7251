"""The proof that a collision is over, from pieces: what it states bounds what happens later."""

import numpy as np
import pytest
from exhaustive import few_of
from networks import unit_rod

import rodimpact as ri
from rodimpact.methods import record_lists
from rodimpact.methods.link import Law
from rodimpact.methods.pieces import finality
from rodimpact.methods.pieces.driver import Members
from rodimpact.methods.pieces.layout import RunRequest
from rodimpact.methods.pieces.records import GROUP_PART, LINK, RUN
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.states import Status


def stepped(rng, velocity, n=3):
    lengths = rng.integers(2, 9, n) / 8
    areas = rng.uniform(0.3, 3, n)
    segments = [
        ri.Segment(float(L), float(A), unit_rod().segments[0].material)
        for L, A in zip(lengths, areas, strict=True)
    ]
    total = float(lengths.sum())
    at = [float(x) * total for x in (0.3, 0.6)]
    swing = ri.Steps((velocity + rng.uniform(-1, 1, 3)).tolist(), at)
    return ri.Rod(
        segments=segments,
        velocity=swing,
        strain=ri.Steps((0.3 * rng.uniform(-1, 1, 3)).tolist(), at),
    )


def surveyed(system):
    """The parts of a row at t = 0."""
    members = Members(build_row(system), RunRequest(8.0, 1e-8, 10**6, keep=True))
    members.batch.to_lists()
    members.load()
    state = members.batch.state
    finality.update_groups(state, 0)
    return state.parts


@pytest.mark.parametrize("seed", few_of(range(12), range(4)))
def test_a_group_swings_within_its_bounds(seed):
    """Both ends of a stepped rod, or of one with a mass on a joint, for some transits."""
    rng = np.random.default_rng(seed)
    rod = stepped(rng, 0.2)
    row = [rod]
    contacts = []
    if seed % 2:
        row.append(
            ri.RigidMass(float(rng.uniform(0.1, 2)), velocity=float(rng.uniform(-1, 1)))
        )
        contacts.append(
            ri.Joint(float(rng.uniform(0.5, 5)), stretch=float(rng.uniform(-0.1, 0.1)))
        )
    system = ri.System(row, contacts=contacts)
    head = surveyed(system)[0]
    s = ri.solve(system, 8.0, "characteristics")
    t = np.linspace(0, 8, 801)
    ends = {
        "left": (0, 0.0),
        "right": (len(row) - 1, rod.length if len(row) == 1 else 0.0),
    }
    for side, (body, x) in ends.items():
        moved = (
            s.displacement(body, x, t)
            - s.displacement(body, x, 0.0)
            - head.group_velocity * t
        )
        off = moved + head.end_deviations[side == "right"] - s.run.clock.frame * t
        reach = np.sqrt(
            2 * head.reference_energy * head.compliance_integrals[side == "right"]
        )
        assert np.abs(off).max() <= reach * (1 + 1e-9)
        assert np.abs(off).max() >= 0.05 * reach  # a bound that says something


@pytest.mark.parametrize("damping", [0.3, 3.0])
def test_a_dashpot_stretches_within_its_bound(damping):
    """A rod of the mass 1 moves the mass 1/2 through a dashpot c alone, which gives way for ever.

    Its right end, as seen from the mass, has 2/3 of all mass beyond it: it moves by at most
    sqrt(2 E) (sqrt(s) + 2 (2/3) sqrt(1)/c), with s = (2/3)^2 L/(3 E A) = 4/27.
    """
    rod = unit_rod(1.0, velocity=1.0)
    system = ri.System(
        [rod, ri.RigidMass(0.5, velocity=-0.5)], contacts=[ri.Joint(0.0, damping)]
    )
    head = surveyed(system)[0]
    reach = np.sqrt(4 / 27) + 4 / (3 * damping)
    assert head.compliance_integrals[1] == pytest.approx(reach**2, rel=1e-9)
    s = ri.solve(system, 8.0, "characteristics")
    t = np.linspace(0, 8, 801)
    moved = s.displacement(1, 0.0, t) - s.displacement(1, 0.0, 0.0)
    off = moved - (head.group_velocity + s.run.clock.frame) * t
    assert np.abs(off).max() <= np.sqrt(2 * head.reference_energy) * reach
    assert np.abs(off).max() > 0.1 * np.sqrt(2 * head.reference_energy) * reach


@pytest.mark.parametrize("seed", few_of(range(12), range(2)))
@pytest.mark.parametrize("law", [ri.Hertz(20.0), ri.SpringDashpot(20.0, 0.5)])
def test_what_is_said_to_be_over_is_over(seed, law):
    """The proof names a time; a run three times as long meets no contact after it."""
    rng = np.random.default_rng(seed)
    system = ri.System(
        [stepped(rng, 1.0, 1), ri.RigidMass(0.5), stepped(rng, -0.3, 1)],
        [0.1, 0.1],
        [law, ri.Spring(50.0)],
    )
    s = ri.solve(system)
    assert s.final
    longer = ri.solve(system, 3 * s.t_end)
    assert [c.episodes for c in longer.contacts] == [
        tuple(pytest.approx(tuple(e), abs=1e-6) for e in c.episodes) for c in s.contacts
    ]
    assert longer.t_final == pytest.approx(s.t_final, rel=1e-6)
    assert s.t_final <= s.t_proved <= s.t_end


def test_the_energy_about_the_mean_is_that_of_the_ledger():
    rng = np.random.default_rng(3)
    system = ri.System([stepped(rng, 0.4)])
    part = surveyed(system)
    book = ri.solve(system, 1.0, "characteristics").energy(0.0)
    assert part[0].reference_energy == pytest.approx(float(book.vibration), rel=1e-12)


@pytest.mark.parametrize(
    ("gap", "opening", "over"),
    [
        (2.01, 1e-3, True),
        (1.99, 1e-3, False),
        (9.0, -1e-3, False),
        (-2.01, 1e-3, False),
    ],
)
def test_a_gap_must_be_wider_than_both_bounds(gap, opening, over):
    """Each side deviates by up to 1: sqrt(2 E slack) with E = 2, slack = 1/4."""
    run, link, *part = (
        record_lists.as_objects(np.zeros(1, kind))[0]
        for kind in (RUN, LINK, PART, PART)
    )
    run.scale = 1.0
    run.tolerance = 1e-12
    run.tick = 1e-9
    link.law = Law.SPRING
    link.status = Status.OPEN
    link.left_group = 0
    link.right_group = 1
    link.overlap = -gap
    for it in part:
        it.bound = 2.0
        it.slack = [0.25, 0.25]
        it.low = -3.0
        it.high = 3.0
    part[1].speed = opening
    assert (finality.time_until_over(run, [link], part) == 0) is over
