"""The two sentences of reason come from the events of the run, not from the names of
presets.
"""

import re
from typing import Any, NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
from explore.scenes import shown
from steel import STEEL, rod

import rodimpact as ri

ALUMINIUM = ri.materials.aluminium
RETURNS = "wave returns after"
ENDS = "and the force ends, since a contact cannot pull"
STEPPED = ri.Rod(
    velocity=1.0, segments=[ri.Segment(0.2, area, STEEL) for area in (1e-4, 3e-4)]
)


class Explained(NamedTuple):
    """A row, and parts of the sentences that explain its collision."""

    bodies: list[Any]
    parts: list[str]
    contacts: list[Any] | None = None
    until: float | None = None


ROWS = {
    "short hits long": Explained(
        [rod(0.4, 1.0), rod(1.0)],
        [
            f"Rod 1's {RETURNS}",
            ENDS,
            "touch without force until they part",
            " = l₁/l₂; ",
        ],
    ),
    "equal": Explained(
        [rod(1.0, 1.0), rod(1.0)],
        [f"Each rod's {RETURNS}", "; 0 % of the energy"],
    ),
    "wall": Explained(
        [rod(1.0, 1.0), ri.Wall()],
        [
            f"Rod 1's {RETURNS}",
            "since a wall cannot pull",
            "the mean velocity to -1 m/s",
        ],
    ),
    # Both waves are back when the force ends.
    "thick hits thin": Explained(
        [rod(0.5, 1.0, 3e-4), rod(1.0)],
        [
            f"Rod 1's {RETURNS}",
            "lowers the force to 0.5 times its value",
            "contact goes on",
            f"Rod 2's {RETURNS}",
            ENDS,
        ],
    ),
    "stepped": Explained([STEPPED, rod(1.0)], ["a wave arrives and lowers the force"]),
    "chain": Explained(
        [rod(0.2, 1.0), rod(0.2), rod(0.2)],
        [
            "first contact to press is that of rod 1 and rod 2",
            "between rod 2 and rod 3, ends",
            "mean velocities after the collision are 0 m/s",
        ],
    ),
    "hertz": Explained(
        [rod(0.4, 1.0), rod(1.0)],
        ["transit times of rod 1; no single wave ends it"],
        contacts=[ri.Hertz(1e10)],
    ),
    "mass": Explained(
        [ri.RigidMass(0.5, velocity=1.0), rod(1.0)], ["2 transit times of rod 2."]
    ),
    "cut short": Explained(
        [rod(0.4, 1.0), rod(1.0)],
        ["press to the end of the run", "before the collision was final."],
        until=1e-4,
    ),
    "apart": Explained(
        [rod(0.4, -1.0), rod(1.0)],
        [
            "No bodies collide: the force stays zero at every contact that can open.",
            "The mean velocities are -1 m/s and 0 m/s",
        ],
    ),
}


@pytest.mark.parametrize("name", ROWS)
def test_the_reason_names_what_happens_at_the_contacts(name):
    """The reason of one of `ROWS` on the page has all parts that are listed for it."""
    row = ROWS[name]
    system = ri.System(row.bodies, contacts=row.contacts)
    options = {}
    if row.until is not None:
        options["until"] = row.until

    _, scene = shown(system, tolerance=1e-4, **options)

    reason = " ".join(scene["reason"])
    for part in row.parts:
        assert part in reason


VIBRATING = rod(0.4).replace(velocity=ri.Steps([2.0, 0.0], [0.2]))
WITHOUT_A_RATIO = {
    "materials": ri.System([rod(0.4, 1.0), rod(1.0, material=ALUMINIUM)]),
    "stepped": ri.System([STEPPED, rod(1.0)]),
    "compliant": ri.System([rod(0.4, 1.0), rod(1.0)], contacts=[ri.Spring(1e11)]),
    "vibrating": ri.System([VIBRATING, rod(1.0)]),
}


def test_e_of_uniform_rods_is_told_as_a_ratio_of_lengths():
    _, scene = shown(ri.System([rod(0.4, 1.0), rod(1.0)]))
    _, result = scene["reason"]
    assert "so e = " in result
    assert "l₁/l₂" in result


@pytest.mark.parametrize("name", few_of(WITHOUT_A_RATIO, ["materials", "compliant"]))
def test_e_of_other_rods_is_not_told_as_a_ratio(name):
    """For one of `WITHOUT_A_RATIO`, the reason on the page tells e as a number, and not
    as a ratio of lengths or transit times.
    """
    _, scene = shown(WITHOUT_A_RATIO[name], tolerance=1e-4)
    _, result = scene["reason"]
    assert "so e = " in result
    assert "/l" not in result  # l1/l2
    assert "/T" not in result  # T1/T2


@pytest.mark.parametrize("seed", few_of(range(8), range(3)))
def test_numbers_of_the_reason_are_those_of_the_solution(seed):
    """Two random rods collide: velocities, e and the share of vibration in the sentence
    on the page are those of the solution, as far as they are rounded.
    """
    rng = np.random.default_rng(seed)
    striker = rod(rng.uniform(0.1, 1.0), rng.uniform(0.5, 2.0), rng.uniform(1e-4, 2e-4))
    struck = rod(rng.uniform(0.1, 1.0), area=rng.uniform(1e-4, 2e-4))

    solution, scene = shown(ri.System([striker, struck]))

    _, sentence = scene["reason"]
    number = r"(-?[\d.e-]+)"
    numbers = re.search(
        rf"velocities to {number} m/s and {number} m/s, so e = {number}\S*; {number} %",
        sentence,
    )
    first, second, e, vibration_percent = map(float, numbers.groups())
    outcome = solution.outcome
    vibration = sum(outcome.vibration_after)
    energy = vibration + outcome.kinetic_after
    assert [first, second] == pytest.approx(outcome.velocities_after, abs=1e-3)
    assert e == pytest.approx(outcome.restitution, rel=5e-6)
    assert vibration_percent == pytest.approx(100 * vibration / energy, rel=0.01)


@pytest.mark.exhaustive
def test_the_weak_tail_of_a_stiff_contact_is_told_from_its_impulse():
    """Nearly flat ends press weakly until they open, and the sentence tells that 99 % of
    the impulse came with the first wave; between rounder ends it tells nothing of it.
    """
    bodies = [rod(0.4, 2.0), rod(1.0)]
    flat = ri.System(bodies, contacts=[ri.Hertz(3e12)])
    round_ends = ri.System(bodies, contacts=[ri.Hertz(3e9)])

    _, scene_of_flat = shown(flat)
    _, scene_of_round = shown(round_ends)

    sentence_of_flat, _ = scene_of_flat["reason"]
    sentence_of_round, _ = scene_of_round["reason"]
    match = re.search(
        r"99 % of the impulse came in the first ([\d.]+) µs", sentence_of_flat
    )
    first_wave = 1e6 * 2 * bodies[0].transit_time  # us
    assert float(match[1]) == pytest.approx(first_wave, rel=0.02)
    assert "came in" not in sentence_of_round
