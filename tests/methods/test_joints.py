"""Joints: springs and dashpots that pull as well, between rods, masses and walls."""

import math

import numpy as np
import pytest
from grid_rows import grid_run
from mistakes import assert_told
from networks import unit_rod
from scipy.linalg import expm

import rodimpact as ri
from rodimpact.methods.grid.proof import present, side_of

QUICK = ri.Material("quick", youngs_modulus=6.0, density=1.5)  # wave speed 2
METHODS = {"characteristics": {}, "finite-difference": {"cells": 64}}
both = pytest.mark.parametrize("method", METHODS)


def solved(system, until, method, **more):
    return ri.solve(system, until, method, **{**METHODS[method], **more})


def quick_rod(length=1.0, **state):
    return ri.Rod(length, area=0.7, material=QUICK, **state)


@both
def test_a_chain_of_masses_swings_as_its_matrix_says(method):
    """Wall, spring, mass, spring and dashpot, mass; the rod beyond is never met."""
    k = (3.0, 5.0)
    c = 0.3
    M = np.array([0.4, 0.7])
    row = ri.System(
        [ri.Wall(), ri.RigidMass(M[0]), ri.RigidMass(M[1], velocity=1.0), unit_rod()],
        [0.0, 0.0, 100.0],
        [ri.Joint(k[0], stretch=0.2), ri.Joint(k[1], c), ri.Rigid()],
    )
    s = solved(row, 6.0, method)
    K = np.array([[k[0] + k[1], -k[1]], [-k[1], k[1]]])
    C = c * np.array([[1.0, -1.0], [-1.0, 1.0]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K / M[:, None], -C / M[:, None]]])
    start = np.array([0.2, 0.2, 0.0, 1.0])
    t = np.arange(0, 6, 1 / 8)
    exact = np.array([expm(A * time) @ start for time in t])
    assert s.contacts[0].gap(t) == pytest.approx(exact[:, 0], abs=1e-3)
    assert s.contacts[1].gap(t) == pytest.approx(exact[:, 1] - exact[:, 0], abs=1e-3)
    assert s.velocity(2, 0.0, t) == pytest.approx(exact[:, 3], abs=3e-3)
    ledger = s.energy(t)
    assert np.abs(ledger.residual).max() < (
        1e-10 if method == "characteristics" else 1e-13
    )
    assert ledger.contact[0] == pytest.approx(k[0] * 0.2**2 / 2, rel=1e-14)
    assert np.diff(ledger.dissipated).min() >= 0


@both
def test_what_hangs_together_meets_as_one(method):
    """A rod strikes a mass that is joined to a rod; both go on with one velocity."""
    joint = ri.Joint(2.0, 0.1)
    row = ri.System(
        [unit_rod(velocity=1.0), ri.RigidMass(0.5), quick_rod()],
        contacts=[ri.Rigid(), joint],
    )
    s = solved(row, None, method)
    assert s.final
    assert s.outcome.unilateral == (0,)
    v = s.outcome.velocities_after
    assert v[1] == v[2] > v[0]
    assert s.outcome.masses @ np.array(v) == pytest.approx(1.0, abs=1e-12)
    assert s.outcome.restitution == pytest.approx(v[1] - v[0], abs=1e-14)
    assert s.contacts[1].episodes == ()
    later = solved(row, 5 * s.t_final, method)
    assert later.outcome.contacts[0].last <= s.t_final * (1 + 1e-12)  # on another clock
    apart = later.contacts[0].gap(np.linspace(s.t_proved, later.t_end, 200))
    assert apart.min() > 0


@both
@pytest.mark.parametrize(
    "joint", [ri.Joint(0.0, 0.5), ri.Joint(0.5)], ids=["dashpot", "spring"]
)
def test_the_proof_counts_on_how_far_a_joint_gives_way(method, joint):
    """What leaves slowly may still be caught by the swing of what hangs on the other side."""
    row = ri.System(
        [unit_rod(velocity=0.99), unit_rod(velocity=1.0), quick_rod(velocity=-0.9)],
        [0.3, 0.0],
        [ri.Rigid(), joint],
    )
    s = solved(row, None, method)
    assert s.final
    assert s.outcome.contacts[0].episodes >= 1
    later = solved(row, 4 * s.t_final, method)
    assert later.outcome.contacts[0].last <= s.t_final * (1 + 1e-12)  # on another clock


def sides_of(system, steps):
    """Mean velocity, deviation and bound, as the proof takes them, left of the last contact.

    At the ends of some steps 1/64, in the laboratory and in SI units.
    """
    run = grid_run(system, steps[-1], step=1 / 64)
    found = []
    for j in steps:
        run.advance(j)
        side = side_of(run, int(run.grid.links["left_node"][-1]), True, present(run))
        found.append((side.mean + run.row.frame, side.deviation, side.bound))
    return found


HANGING = {
    "free": [
        ri.RigidMass(0.5, velocity=-1.0),
        quick_rod(velocity=0.2),
        unit_rod(velocity=0.4),
    ],
    "wall": [ri.Wall(), quick_rod(velocity=0.2), unit_rod(velocity=0.4)],
}


@pytest.mark.parametrize("start", HANGING)
@pytest.mark.parametrize("law", ["soft", "dashpot"])
def test_an_end_beyond_joints_is_where_the_proof_says_and_stays_within_its_bound(
    start, law
):
    """Far from all else: the centre of mass, strains and stretches; what a dashpot gave way."""
    joints = {
        "soft": [ri.Joint(0.02, stretch=0.3), ri.Joint(0.05, 0.01)],
        "dashpot": [ri.Joint(0.0, 0.05), ri.Joint(0.0, 0.3)],
    }[law]
    system = ri.System(
        [*HANGING[start], unit_rod()], [0.0, 0.0, 90.0], [*joints, ri.Rigid()]
    )
    steps = [0, 64, 320, 640, 1280]
    s = ri.solve(system, 20.0, "finite-difference", dt=1 / 64)
    (V, d, bound), *later = sides_of(system, steps)
    moved = s.displacement(2, 1.0, np.array(steps[1:]) / 64)
    for j, end, (now, then, limit) in zip(steps[1:], moved, later, strict=True):
        assert now == pytest.approx(V, abs=1e-10)
        assert abs(end - V * j / 64 + d) <= bound
        assert limit <= bound * (1 + 1e-9)
        if law == "soft":
            assert end == pytest.approx(V * j / 64 + then - d, abs=1e-9)
    assert max(abs(moved - V * np.array(steps[1:]) / 64 + d)) > bound / 10


@both
def test_a_compressed_joint_lets_go(method):
    """All is at rest, and yet something will meet."""
    row = ri.System(
        [unit_rod(), unit_rod(), unit_rod()],
        [0.0, 0.02],
        [ri.Joint(2.0, stretch=-0.1), ri.Rigid()],
        ends=(ri.Fixed(), ri.Free()),
    )
    s = solved(row, None, method, max_events=20_000)
    assert s.outcome.contacts[1].episodes >= 1
    assert s.outcome.velocities_after[2] > 0


@both
def test_prestress_rests(method):
    """Rods under tension between fixed ends, held together by a stretched joint."""
    tension = 0.02
    row = ri.System(
        [unit_rod(strain=tension), quick_rod(strain=tension / (6.0 * 0.7))],
        contacts=[ri.Joint(5.0, 0.4, stretch=tension / 5.0)],
        ends=(ri.Fixed(), ri.Fixed()),
    )
    s = solved(row, 3.0, method)
    t = np.linspace(0, 3, 50)
    assert s.contacts[0].force(t) == pytest.approx(np.full(50, -tension), abs=1e-14)
    assert np.abs(s.velocity(0, 0.7, t)).max() < 1e-14
    assert s.outcome.contact_energy_before == pytest.approx(tension**2 / 10.0)


def test_a_state_goes_on_with_its_stretch():
    row = ri.System(
        [unit_rod(velocity=1.0), quick_rod()], contacts=[ri.Joint(3.0, 0.4)]
    )
    whole = solved(row, 4.0, "characteristics")
    rest = solved(whole.system_at(1.5), 2.5, "characteristics")
    assert rest.system.gaps == (0.0,)
    assert rest.system.contacts[0].stretch == float(whole.contacts[0].gap(1.5)) != 0
    t = np.linspace(0, 2.5, 40)
    # jumps of the state are straight lines over two samples
    assert rest.contacts[0].gap(t) == pytest.approx(
        whole.contacts[0].gap(1.5 + t), abs=2e-6
    )
    between = [
        s.position(1, 0.0, s.t_end) - s.position(0, 1.0, s.t_end) for s in (whole, rest)
    ]
    assert between == pytest.approx([whole.contacts[0].gap(4.0)] * 2, abs=2e-6)


def test_a_stiff_joint_is_a_bond():
    def e(law):
        row = ri.System(
            [unit_rod(velocity=1.0), unit_rod(0.5), quick_rod()],
            contacts=[ri.Rigid(), law],
        )
        return ri.solve(row, method="characteristics").outcome.restitution

    bonded, *joined = (e(law) for law in (ri.Bonded(), ri.Joint(1e3), ri.Joint(1e5)))
    assert abs(joined[1] - bonded) < 1e-3
    assert abs(joined[1] - bonded) < abs(joined[0] - bonded) / 10


PAIR = [unit_rod(), unit_rod()]


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        (
            lambda: ri.Joint(0.0),
            {"stiffness": "=must be positive where the damping is 0, got 0.0"},
        ),
        (lambda: ri.Joint([1.0, 0.0], [0.0, 0.0]), {"stiffness[1]": ""}),
        (
            lambda: ri.Joint(-1.0, math.nan, math.inf),
            {"stiffness": "", "damping": "", "stretch": ""},
        ),
        (
            lambda: ri.System(PAIR, [1e-3], [ri.Joint(1.0)]),
            {"gaps.0": "must be 0 where bodies are joined, got 0.001; a Joint takes"},
        ),
        (
            ri.System(PAIR, contacts=[ri.Joint(1.0, 0.1)]).reversed,
            {"contacts.0.damping": ""},
        ),
        (
            lambda: ri.solve(ri.System(PAIR, contacts=[ri.Joint(1e30)]), 1.0),
            {"contacts.0.stiffness": "use Bonded()"},
        ),
    ],
)
def test_mistakes_of_joints(make, wanted):
    assert_told(make, wanted)
