"""A contact law of one's own beside the laws of the package that it repeats."""

import pickle

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.methods import compiling, contact_laws, kernels, record_lists
from rodimpact.methods.link import Law
from rodimpact.methods.pieces.records import LINK

STEEL = ri.materials.steel
BAR = ri.Rod(1.0, area=1e-4, material=STEEL)
LAWS = {
    "spring": (lambda d, _: 1e8 * d, ri.Spring(1e8)),
    "hertz": (lambda d, _: 1e10 * d**1.5, ri.Hertz(1e10)),
    "dashpot": (lambda d, rate: 1e8 * d + 500.0 * rate, ri.SpringDashpot(1e8, 500.0)),
    "hunt-crossley": (
        lambda d, rate: 1e10 * d**1.5 * (1 + 0.3 * rate),
        ri.HuntCrossley(1e10, damping=0.3),
    ),
}


def power(d, _):
    return 1e10 * d**1.5


def rows(law):
    striker = BAR.replace(length=0.4, velocity=1.0)
    mass = ri.RigidMass(0.1, velocity=1.0)
    return [
        ri.System([striker, BAR], contacts=[law]),
        ri.System([striker, BAR], gaps=[1e-5], contacts=[law]),
        ri.System([mass, ri.RigidMass(0.05), BAR], contacts=[law, law]),
    ]


@pytest.mark.parametrize("name", few_of(LAWS, {"hertz", "dashpot"}))
def test_a_law_of_ones_own_is_that_of_the_package(name):
    function, law = LAWS[name]
    for own, same in zip(rows(ri.Law(function)), rows(law), strict=True):
        a, b = (ri.solve(row, 1e-3) for row in (own, same))
        assert a.method == "characteristics"
        assert a.outcome.velocities_after == pytest.approx(
            b.outcome.velocities_after, abs=1e-10
        )
        for one, other in zip(a.outcome.contacts, b.outcome.contacts, strict=True):
            assert one.impulse == pytest.approx(other.impulse, rel=1e-10)
            assert one.peak_force == pytest.approx(other.peak_force, rel=1e-9)
        assert a.outcome.dissipated == pytest.approx(b.outcome.dissipated, abs=1e-9)


def test_energy_that_is_stored_is_the_integral_of_the_force():
    assert ri.Law(power).stored([0.0, 1e-4]) == pytest.approx(
        ri.Hertz(1e10).stored([0.0, 1e-4])
    )


def test_a_contact_does_not_pull_where_the_force_is_negative():
    law = ri.Law(lambda d, rate: 1e8 * d + 5e3 * rate)
    solution = ri.solve(rows(law)[0])
    times = np.linspace(0, solution.t_end, 4001)
    assert solution.contacts[0].force(times).min() >= 0


def test_members_of_a_family_are_single_runs():
    row = rows(ri.Law(power))[0]
    family = row.replace(
        bodies=[row.bodies[0].replace(velocity=np.array([1.0, 3.0])), BAR]
    )
    result = ri.sweep(family)
    assert result.restitution.tolist() == [
        ri.solve(family[i]).outcome.restitution for i in range(2)
    ]


@pytest.fixture
def own():
    """Two functions that numba has compiled, by their numbers."""
    if kernels.why_not():
        pytest.skip("there is no compiler")
    numba = pytest.importorskip("numba")
    return (3, numba.njit(power)), (
        5,
        numba.njit(lambda d, rate: 2e8 * d + 100.0 * rate),
    )


def test_compiled_and_plain_kernels_call_the_function_of_a_link(own):
    links = np.zeros(2, LINK)
    links["law"], links["function"] = Law.OWN, [3, 5]
    links["mobility"] = 1e-3
    links["overlap_step"] = 1e-9
    links["rate_step"] = 1e-6
    fast, plain = (
        make(contact_laws.force, own)
        for make in (compiling.compiled, compiling.interpreted)
    )
    for link, object_, (_, function) in zip(
        links, record_lists.as_objects(links), own, strict=True
    ):
        for d, closing in ((1e-5, 1.0), (2e-4, -0.3)):
            F, *slopes = fast(link, d, closing)
            assert (F, *slopes) == plain(object_, d, closing)
            assert pytest.approx(function(d, closing - 1e-3 * F), rel=1e-12) == F


@pytest.mark.exhaustive
def test_what_numba_has_compiled_runs_compiled(own):
    mass = ri.RigidMass(0.1, velocity=1.0)
    given = [ri.Law(function) for _, function in own]
    row = ri.System([mass, BAR, ri.RigidMass(0.2)], contacts=given)
    plain = ri.solve(row, 1e-3).outcome
    with kernels.forced(True):
        assert ri.solve(row, 1e-3).outcome.velocities_after == plain.velocities_after


@pytest.mark.parametrize(
    ("force", "said"),
    [
        (3, "must be a function"),
        (lambda d: d, "fails at d = 0 m"),
        (lambda d, rate: 1.0, "must be 0 at d = 0 m"),
        (lambda d, rate: d / 0.0 if d else 0.0, "ZeroDivisionError"),
    ],
)
def test_what_is_no_law(force, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.Law(force)


def test_only_characteristics_have_it_and_no_file_keeps_it(tmp_path):
    row = rows(ri.Law(power))[0]
    for method in ("fronts", "finite-difference"):
        with pytest.raises(
            ri.InvalidModel, match=r"contacts\.0\.law: .* Python function"
        ):
            ri.solve(row, method=method)
    with pytest.raises(ri.InvalidModel, match="cannot be kept in a file"):
        ri.solve(row).save(tmp_path / "run.toml")
    assert not list(tmp_path.iterdir())
    assert pickle.loads(pickle.dumps(row)) == row
    assert row != rows(ri.Law(LAWS["spring"][0]))[0]
