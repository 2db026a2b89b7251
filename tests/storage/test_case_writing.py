"""What is written reads back equal."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from case_texts import ROD, STEEL
from networks import move_together
from systems import random_system

import rodimpact as ri
from rodimpact.storage.casefile import Case, GaugePlace, parse_case, write_case


def test_written_cases_read_back_equal():
    case = Case(ri.System([ROD]), {"until": 1e-3, "method": "fronts", "max_events": 5},
                {"plot": 'a "b" \\ \x7f\n€.png'}, gauges=(GaugePlace(0, 0.25), GaugePlace(0, 1.0)))
    assert parse_case(write_case(case), "") == case


@pytest.mark.parametrize("seed", range(40))
def test_written_systems_read_back_equal(seed):
    system = random_system(seed)
    again = parse_case(write_case(system)).system
    assert again == system
    assert again.digest == system.digest


def random_profile(rng, end):
    kind = rng.integers(4)
    if kind == 0:
        return rng.normal()
    if kind == 1:
        return ri.Steps(rng.normal(size=3), np.sort(rng.uniform(0, end, size=2)))
    if kind == 2:
        step = None if end < 1 else rng.uniform(1e-6, 1)
        return ri.Samples(rng.normal(size=rng.integers(2, 9)), step)
    return -0.0


def random_row(seed):
    """Bodies, laws and ends of every kind."""
    rng = np.random.default_rng(seed)

    def piece():
        areas, polar = [1e-4, ri.Samples(rng.uniform(1, 2, size=5))], [None, "circular", 1e-8]
        tapered = rng.integers(2)
        moment = polar[rng.integers(3 - tapered)]
        theory = moment and ("mindlin-herrmann" if rng.random() < 0.5 else "rayleigh-love")
        return ri.Segment(rng.uniform(0.1, 1), areas[tapered], STEEL, polar_moment=moment,
                          lateral_inertia=theory)

    def rod():
        pieces = [piece() for _ in range(rng.integers(1, 3))]
        return ri.Rod(segments=pieces, velocity=random_profile(rng, 0.1),
                      strain=random_profile(rng, 0.1))

    def mass():
        return ri.RigidMass(rng.uniform(0.1, 9), velocity=rng.normal())

    laws = [
        ri.Bonded, lambda: ri.Spring(rng.uniform(1, 1e9)), lambda: ri.Hertz(rng.uniform(1, 1e9)),
        lambda: ri.SpringDashpot(*rng.uniform(1, 1e9, size=2)),
        lambda: ri.HuntCrossley(*rng.uniform(1, 1e9, size=2)),
        lambda: ri.Hertz.from_radii(rng.uniform(0, 1), math.inf, STEEL, None),
    ]
    bodies = [rod(), *(mass() if rng.random() < 0.5 else rod() for _ in range(rng.integers(5)))]
    rng.shuffle(bodies)
    ends = [ri.Free(), ri.Pushed(random_profile(rng, 2.0)), ri.Fixed(), ri.Absorbing(),
            ri.Moved(random_profile(rng, 2.0)), ri.Incoming(random_profile(rng, 2.0))]
    pair = [ends[rng.integers(2 if isinstance(bodies[i], ri.RigidMass) else 6)] for i in (0, -1)]
    if rng.random() < 0.3:
        bodies, pair[1] = [*bodies, ri.Wall(rng.normal())], ri.Free()
    contacts, gaps = [], []
    for one, other in pairwise(bodies):
        rigid = ri.Rigid() if ri.Rod in (type(one), type(other)) else ri.Rigid(rng.random())
        contacts.append(rigid if rng.random() < 0.3 else laws[rng.integers(len(laws))]())
        gaps.append(0.0 if contacts[-1] == ri.Bonded() else rng.uniform(0, 1e-3))
    move_together(bodies, contacts)
    gravity = rng.normal() if rng.random() < 0.5 else 0.0
    return ri.System(bodies, gaps, contacts, gravity=gravity, ends=pair)


@pytest.mark.parametrize("seed", range(60))
def test_written_systems_of_every_kind_read_back_equal(seed):
    system = random_row(seed)
    again = parse_case(write_case(system)).system
    assert again == system
    assert again.digest == system.digest
    assert ri.System.from_dict(json.loads(json.dumps(system.to_dict()))) == system
    assert system.mirrored().mirrored().ends == system.ends


@pytest.mark.parametrize("name", ["two words", "a.b", 'quote"', "Ä", "steel"])
def test_materials_of_any_name(name):
    material = ri.Material(name, youngs_modulus=0.1, density=1e100, viscosity=3)
    system = ri.System([ri.Rod(0.4, area=1e-4, material=material, velocity=-1e-7)])
    assert parse_case(write_case(system)).system == system


def test_a_family_is_no_case():
    system = ri.System([ri.Rod([1.0, 2.0], area=1e-4, material=STEEL)])
    with pytest.raises(ri.InvalidModel, match=r"shape \(2,\).*system\[index\]"):
        write_case(system)
    assert parse_case(write_case(system[1])).system == system[1]


def test_two_materials_of_one_name_cannot_be_written():
    other = ri.Material("steel", youngs_modulus=1e9, density=1000)
    system = ri.System([ROD, ri.Rod(1.0, area=1e-4, material=other)])
    with pytest.raises(ri.InvalidModel, match=r"bodies\.1\.material: .*'steel'.*rename"):
        write_case(system)
