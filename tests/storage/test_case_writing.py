"""What is written reads back equal."""

import json

import pytest
from case_texts import ROD, STEEL
from grid_rows import random_row

import rodimpact as ri
from rodimpact.storage.casefile import Case, GaugePlace, parse_case, write_case


def test_written_cases_read_back_equal():
    case = Case(ri.System([ROD]), {"until": 1e-3, "method": "fronts", "max_events": 5},
                {"plot": 'a "b" \\ \x7f\n€.png'}, gauges=(GaugePlace(0, 0.25), GaugePlace(0, 1.0)))
    assert parse_case(write_case(case), "") == case


def test_written_systems_of_every_kind_read_back_equal():
    for seed in range(40):
        system = random_row(seed, driven=True)
        again = parse_case(write_case(system)).system
        assert again == system, seed
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
