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
LAWS = {  # functions of overlap and closing velocity, and the laws that they repeat
    "spring": (lambda d, _: 1e8 * d, ri.Spring(1e8)),
    "hertz": (lambda d, _: 1e10 * d**1.5, ri.Hertz(1e10)),
    "dashpot": (
        lambda d, rate: 1e8 * d + 500.0 * rate,
        ri.SpringDashpot(1e8, damping=500.0),
    ),
    "hunt-crossley": (
        lambda d, rate: 1e10 * d**1.5 * (1 + 0.3 * rate),
        ri.HuntCrossley(1e10, damping=0.3),
    ),
}


def power(d, _):
    """The force of `ri.Hertz(1e10)`."""
    return 1e10 * d**1.5


def pair(law, gap=0.0):
    """System of a bar at 1 m/s that strikes a longer one through a law."""
    striker = BAR.replace(length=0.4, velocity=1.0)
    return ri.System([striker, BAR], gaps=[gap], contacts=[law])


def masses_and_bar(law):
    """System of two masses, of which the first moves, before a bar."""
    mass = ri.RigidMass(0.1, velocity=1.0)
    struck = ri.RigidMass(0.05)
    return ri.System([mass, struck, BAR], contacts=[law, law])


def rows_with(law):
    """Rows of rods and of masses with this law between all bodies."""
    return [pair(law), pair(law, gap=1e-5), masses_and_bar(law)]


@pytest.mark.parametrize("name", few_of(LAWS, {"dashpot"}))
def test_outcomes_of_a_law_of_ones_own_are_those_of_the_law_that_it_repeats(name):
    """Velocities, impulses, peak forces and losses of three rows agree."""
    function, law = LAWS[name]
    own_rows = rows_with(ri.Law(function))
    pairs = zip(own_rows, rows_with(law), strict=True)
    for own_row, row in pairs:
        expected = ri.solve(row, until=1e-3).outcome

        solution = ri.solve(own_row, until=1e-3)

        assert solution.method == "characteristics"
        outcome = solution.outcome
        velocities = np.array(outcome.velocities_after)
        expected_velocities = expected.velocities_after
        assert velocities == pytest.approx(expected_velocities, abs=1e-10)
        contacts = zip(outcome.contacts, expected.contacts, strict=True)
        for contact, other in contacts:
            assert contact.impulse == pytest.approx(other.impulse, rel=1e-10)
            assert contact.peak_force == pytest.approx(other.peak_force, rel=1e-9)
        lost = expected.dissipated
        assert outcome.dissipated == pytest.approx(lost, abs=1e-9)


def test_energy_that_is_stored_is_the_integral_of_the_force():
    """`stored` of a user's law with the force of a Hertz contact is that of this
    contact.
    """
    overlaps = [0.0, 1e-4]
    hertz = ri.Hertz(1e10)
    own_law = ri.Law(power)
    expected = hertz.stored(overlaps)
    assert own_law.stored(overlaps) == pytest.approx(expected)


def test_a_contact_does_not_pull_where_the_force_is_negative():
    """The function of this dashpot is negative while the overlap goes back fast."""
    law = ri.Law(lambda d, rate: 1e8 * d + 5e3 * rate)

    solution = ri.solve(pair(law))

    times = np.linspace(0, solution.t_end, 4001)
    force = solution.contacts[0].force(times)
    assert force.min() >= 0


@pytest.mark.exhaustive
def test_members_of_a_family_are_single_runs():
    """Restitutions of a sweep over two speeds are those of two runs."""
    speeds = np.array([1.0, 3.0])
    striker = BAR.replace(length=0.4, velocity=speeds)
    law = ri.Law(power)
    family = ri.System([striker, BAR], contacts=[law])

    result = ri.sweep(family)
    restitutions = []
    for i in range(2):
        alone = ri.solve(family[i])
        restitutions.append(alone.outcome.restitution)

    assert result.restitution.tolist() == restitutions


@pytest.mark.parametrize("method", ["fronts", "finite-difference"])
def test_methods_other_than_characteristics_refuse_it(method):
    message = r"contacts\.0\.law: .* Python function"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.solve(pair(ri.Law(power)), method=method)


@pytest.fixture
def own_laws():
    """Two functions that numba has compiled, each behind the number by which links name
    it.
    """
    if kernels.why_not():
        pytest.skip("there is no compiler")
    numba = pytest.importorskip("numba")

    def dashpot(d, rate):
        return 2e8 * d + 100.0 * rate

    compiled_power = numba.njit(power)
    compiled_dashpot = numba.njit(dashpot)
    return (3, compiled_power), (5, compiled_dashpot)


def test_compiled_and_plain_kernels_call_the_function_of_a_link(own_laws):
    """F = function(d, closing - mobility F), with the same bits."""
    mobility = 1e-3
    records = np.zeros(2, LINK)
    records["law"] = Law.OWN
    records["mobility"] = mobility
    records["overlap_step"] = 1e-9  # of difference quotients
    records["rate_step"] = 1e-6
    compiled_force = compiling.compiled(contact_laws.force, own_laws)
    plain_force = compiling.interpreted(contact_laws.force, own_laws)

    pairs = zip(records, own_laws, strict=True)
    for record, (number, function) in pairs:
        record["function"] = number
        one_record = np.array([record])
        (link,) = record_lists.as_objects(one_record)
        for d, closing in [(1e-5, 1.0), (2e-4, -0.3)]:
            by_compiled = compiled_force(record, d, closing)
            assert by_compiled == plain_force(link, d, closing)
            F, *_ = by_compiled
            rate = closing - mobility * F
            expected = function(d, rate)
            assert pytest.approx(expected, rel=1e-12) == F


@pytest.mark.exhaustive
def test_functions_that_numba_has_compiled_run_the_same_compiled(own_laws):
    """Velocities of a row with both laws are equal bit for bit in plain Python and in
    machine code.
    """
    mass = ri.RigidMass(0.1, velocity=1.0)
    laws = [ri.Law(function) for _, function in own_laws]
    last_mass = ri.RigidMass(0.2)
    row = ri.System([mass, BAR, last_mass], contacts=laws)

    plain = ri.solve(row, until=1e-3).outcome
    with kernels.forced(compiling=True):
        compiled = ri.solve(row, until=1e-3).outcome

    assert compiled.velocities_after == plain.velocities_after


@pytest.mark.parametrize(
    ("force", "said"),
    [
        (3, "must be a function"),
        (lambda d: d, "fails at d = 0 m"),
        (lambda d, rate: 1.0, "must be 0 at d = 0 m"),
        (lambda d, rate: d / 0.0 if d else 0.0, "ZeroDivisionError"),
        (lambda d, rate: -1e9 * d, "must not fall with d or d'"),
        (lambda d, rate: 1e9 * d - 1e3 * rate, "must not fall with d or d'"),
    ],
)
def test_functions_that_are_no_law_are_refused(force, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.Law(force)


@pytest.mark.exhaustive
def test_a_solution_with_it_is_refused_by_a_file_and_leaves_none(tmp_path):
    solution = ri.solve(pair(ri.Law(power)))
    with pytest.raises(ri.InvalidModel, match="cannot be kept in a file"):
        solution.save(tmp_path / "run.toml")
    assert not list(tmp_path.iterdir())


def test_laws_are_equal_if_their_functions_are_also_after_pickling():
    """A system with a user's law is equal to itself after pickling, and not to one with
    another function.
    """
    system = pair(ri.Law(power))
    other_function, _ = LAWS["spring"]
    pickled = pickle.dumps(system)
    assert pickle.loads(pickled) == system
    assert system != pair(ri.Law(other_function))
