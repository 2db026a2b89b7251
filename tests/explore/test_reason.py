"""The two sentences of reason come from the events of the run, not from the names of
presets.
"""

import re

import numpy as np
import pytest
from explore.scenes import shown
from steel import STEEL, rod

import rodimpact as ri

ALUMINIUM = ri.materials.aluminium
RETURNS = "wave returns after"
ENDS = "and the force ends, since a contact cannot pull"
STEPPED = ri.Rod(
    velocity=1.0, segments=[ri.Segment(0.2, area, STEEL) for area in (1e-4, 3e-4)]
)
SYSTEMS = {
    "short hits long": (
        [rod(0.4, 1.0), rod(1.0)],
        {},
        {},
        [
            f"Rod 1's {RETURNS}",
            ENDS,
            "touch without force until they part",
            " = l₁/l₂; ",
        ],
    ),
    "equal": (
        [rod(1.0, 1.0), rod(1.0)],
        {},
        {},
        [f"Each rod's {RETURNS}", "; 0 % of the energy"],
    ),
    "wall": (
        [rod(1.0, 1.0), ri.Wall()],
        {},
        {},
        [
            f"Rod 1's {RETURNS}",
            "since a wall cannot pull",
            "the mean velocity to -1 m/s",
        ],
    ),
    "thick hits thin": (
        [rod(0.5, 1.0, 3e-4), rod(1.0)],
        {},
        {},
        [  # both waves are back in the end
            f"Rod 1's {RETURNS}",
            "lowers the force to 0.5 times its value",
            "contact goes on",
            f"Rod 2's {RETURNS}",
            ENDS,
        ],
    ),
    "stepped": ([STEPPED, rod(1.0)], {}, {}, ["a wave arrives and lowers the force"]),
    "chain": (
        [rod(0.2, 1.0), rod(0.2), rod(0.2)],
        {},
        {},
        [
            "first contact to press is that of rod 1 and rod 2",
            "between rod 2 and rod 3, ends",
            "mean velocities after the collision are 0 m/s",
        ],
    ),
    "hertz": (
        [rod(0.4, 1.0), rod(1.0)],
        {"contacts": [ri.Hertz(1e10)]},
        {},
        ["transit times of rod 1; no single wave ends it"],
    ),
    "mass": (
        [ri.RigidMass(0.5, velocity=1.0), rod(1.0)],
        {},
        {},
        ["2 transit times of rod 2."],
    ),
    "cut short": (
        [rod(0.4, 1.0), rod(1.0)],
        {},
        {"until": 1e-4},
        [
            "press to the end of the run",
            "before the collision was final.",
        ],
    ),
    "apart": (
        [rod(0.4, -1.0), rod(1.0)],
        {},
        {},
        [
            "No bodies collide: the force stays zero at every contact that can open.",
            "The mean velocities are -1 m/s and 0 m/s",
        ],
    ),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_reason_names_what_happens_at_the_contacts(name):
    bodies, how, solve, words = SYSTEMS[name]
    _, scene = shown(ri.System(bodies, **how), **solve)
    reason = " ".join(scene["reason"])
    assert [word for word in words if word not in reason] == []


CLAIMS = {  # bodies, further arguments of the system, whether e is the ratio
    "uniform": ([rod(0.4, 1.0), rod(1.0)], {}, True),
    "materials": ([rod(0.4, 1.0), rod(1.0, material=ALUMINIUM)], {}, False),
    "stepped": ([STEPPED, rod(1.0)], {}, False),
    "compliant": ([rod(0.4, 1.0), rod(1.0)], {"contacts": [ri.Spring(1e11)]}, False),
    "vibrating": (
        [rod(0.4).replace(velocity=ri.Steps([2.0, 0.0], [0.2])), rod(1.0)],
        {},
        False,
    ),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_e_is_a_ratio_of_lengths_only_where_that_holds(name):
    bodies, how, holds = CLAIMS[name]
    _, scene = shown(ri.System(bodies, **how))
    sentence = scene["reason"][1]
    assert "so e = " in sentence
    names_a_ratio = "/l" in sentence or "/T" in sentence  # l1/l2 or T1/T2
    assert names_a_ratio == holds


@pytest.mark.parametrize("seed", range(8))
def test_numbers_of_the_reason_are_those_of_the_solution(seed):
    rng = np.random.default_rng(seed)
    system = ri.System(
        [
            rod(rng.uniform(0.1, 1.0), rng.uniform(0.5, 2.0), rng.uniform(1e-4, 2e-4)),
            rod(rng.uniform(0.1, 1.0), area=rng.uniform(1e-4, 2e-4)),
        ]
    )
    solution, scene = shown(system)
    sentence = scene["reason"][1]
    outcome = solution.outcome
    number = r"(-?[\d.e-]+)"
    first, second, e, share = re.search(
        rf"velocities to {number} m/s and {number} m/s, so e = {number}\S*; {number} %",
        sentence,
    ).groups()
    assert [float(first), float(second)] == pytest.approx(
        outcome.velocities_after, abs=1e-3
    )
    assert float(e) == pytest.approx(outcome.restitution, rel=5e-6)
    vibration = sum(outcome.vibration_after)
    assert float(share) == pytest.approx(
        100 * vibration / (vibration + outcome.kinetic_after), rel=0.01
    )


def test_the_weak_tail_of_a_stiff_contact_is_told_from_its_impulse():
    """Nearly flat ends press weakly until they open; the impulse came with the first
    wave.
    """
    bodies = [rod(0.4, 2.0), rod(1.0)]
    flat = ri.System(bodies, contacts=[ri.Hertz(3e12)])
    round_ends = ri.System(bodies, contacts=[ri.Hertz(3e9)])
    sentence = shown(flat)[1]["reason"][0]
    tail = re.search(r"99 % of the impulse came in the first ([\d.]+) µs", sentence)
    first_wave = 1e6 * 2 * bodies[0].transit_time
    assert float(tail[1]) == pytest.approx(first_wave, rel=0.02)
    assert "came in" not in shown(round_ends)[1]["reason"][0]
