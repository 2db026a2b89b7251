"""Guesses that a new user makes and that are wrong: each is answered by a remedy.

A row holds a guess in Python, or a command, and the part of the answer that helps.
"""

import copy
import inspect
import shlex

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS

import rodimpact as ri
from rodimpact import hints
from rodimpact.cli import main
from rodimpact.hints import explain_arguments, explain_missing
from rodimpact.model.frozen import Frozen

NAMES = [
    ("ri.rod", "perhaps 'Rod' is meant"),
    ("ri.Sytem", "perhaps 'System' is meant"),
    ("ri.simulate", "perhaps 'solve' is meant"),
    ("ri.Mass", "perhaps 'RigidMass' is meant"),
    ("ri.steel", "perhaps 'materials.steel' is meant"),
    ("ri.Steel", "perhaps 'materials.steel' is meant"),
    ("ri.striker", "perhaps 'design.striker' is meant"),
    ("ri.Bar", "perhaps 'Rod' is meant"),
    ("ri.animate", "rodimpact.plot.animation(solution) makes a film"),
    ("ri.from_toml", "perhaps 'read_case' is meant"),
    ("ri.export", "rodimpact.explore(system).save(path) writes the page"),
    ("ri.plot.save(solution, 'a.png')", "such as plot.overview(solution)"),
    ("family.plot()", "plot.sweep for a family"),
    ("ri.materials.steal", "perhaps 'steel' is meant"),
    ("ri.plot.space_time", "perhaps 'spacetime' is meant"),
    ("ri.plot.forces", "perhaps 'contact' is meant"),
    ("ri.theory.stvenant", "perhaps 'saint_venant' is meant"),
    ("ri.rigid.collision", "perhaps 'collide' is meant"),
    ("ri.waves.mode", "use one of Bar, first_mode"),
    (
        "ri.units.convert(3, 'mm', 'm')",
        "use one of conversion, format_si, in_si, parse",
    ),
    ("solution.contacts.force", "ask one of its items, such as [0].force"),
    ("solution.outcome.contacts.impulse", "such as [0].impulse"),
    ("system.bodies.velocity", "such as [0].velocity"),
    ("ri.design.strikr", "perhaps 'striker' is meant"),
    ("solution.restitution", "perhaps 'outcome.restitution' is meant"),
    ("solution.e", "perhaps 'outcome.restitution' is meant"),
    ("solution.animate()", "rodimpact.plot.animation(solution) makes a film"),
    ("solution.force(1e-4)", "perhaps 'contacts[0].force' is meant"),
    ("solution.gravity", "perhaps 'system.gravity' is meant"),
    ("system.solve()", "rodimpact.solve(system) solves it"),
    ("ri.rigid.bounce", "perhaps 'stack_drop' is meant"),
    ("ri.solve(solution)", "got a Solution: give its System, the attribute system"),
    ("ri.rigid.stack_drop([1, 2], [0.9], 1)", "and one restitution for each: first"),
    ("solution.plot()", "functions of rodimpact.plot draw it"),
    ("solution.outcome.contact_time", "opening - start of contacts[k].episodes"),
    ("solution.outcome.energy_lost", "perhaps 'dissipated' is meant"),
    ("system.rods", "perhaps 'bodies' is meant"),
    ("system.length", "perhaps 'bodies[0].length' is meant"),
    ("system[0]", "its bodies are system.bodies"),
    ("rod.area", "perhaps 'segments[0].area' is meant"),
    ("rod.rho", "perhaps 'segments[0].material.density' is meant"),
    ("steel.E", "perhaps 'youngs_modulus' is meant"),
    ("family.velocity_after", "perhaps 'velocities_after' is meant"),
    ("family.e", "perhaps 'restitution' is meant"),
    ("family.columns['e']", "perhaps 'restitution' is meant"),
    ("family.parameters['length']", "use one of bodies.0.length"),
    ("rigid.v1", "perhaps 'velocity_1' is meant"),
    ("rigid.energy_loss", "perhaps 'energy_lost' is meant"),
    ("signal.time", "perhaps 'times' is meant"),
    ("ri.gradient(system, wrt=['lenght'])", "use one that begins with bodies"),
    ("ri.closed_form(system, ['lenght'])", "perhaps 'length' is meant"),
    ("ri.HertzContact", "use one of Hertz, "),
    ("ri.compare", "plot.comparison(measured, predicted) draws it"),
    ("ri.newtons_cradle", "dir(rodimpact) lists its names"),
    ("family.to_pandas()", "perhaps 'to_dataframe' is meant"),
    ("family.accuracy", 'give sweep(..., also=["accuracy"])'),
    ("ri.plot.energy(solution).axes", "perhaps 'ax' is meant"),
    ("ri.materials['steel']", "write materials.steel"),
    ("ri.materials['steal']", "perhaps 'materials.steel' is meant"),
    ("solution.accuracy['velocities']", "there are no entries"),
    ("smooth.accuracy['velocities']", "perhaps 'velocity' is meant"),
    ("ri.gradient(system, 'e', ['bodies.0.length'])", "perhaps 'restitution' is"),
    ("ri.gradient(stepped, wrt=['bodies.0.area'])", "of bodies.0.segments.0.area, bod"),
    ("solution.contacts[0].peak_force_time", "b.times[b.force.argmax()]"),
    ("ri.plot.energy(solution).savefig('a.png')", "plot.save(picture, path) writes"),
    ("ri.plot.energy(solution).save('a.png')", "plot.save(picture, path) writes it"),
    ("ri.plot.energy(solution).show()", "rodimpact.plot.show(picture) shows"),
    ("ri.plot(solution)", "plot.overview(solution) draws a solution"),
    ("solution.contacts[1]", "there is no [1]: the items are [0] to [0]"),
    ("system.bodies[-3]", "there is no [-3]: the items are [0] to [1]"),
    ("solution.to_csv('a.csv')", "gauges_to_csv(path, {name: "),
]
UNITS = [
    ("ri.Rod('400 mm', area=1e-4, material=steel)", "units.parse reads text"),
    ("ri.solve(system, until='1 ms')", "units.parse reads text with a unit"),
    ("ri.units.parse('2 tons', 'mass')", "a metric one is 1 t, a US one 2000 lb"),
    ("ri.units.parse('2 tonnes', 'mass')", "perhaps 't' is meant"),
    ("ri.units.parse('30 tonf', 'force')", "a metric one is 9.80665 kN, a US one"),
    ("ri.units.parse('3 m', 'time')", "Use one of s, ms, us, ns"),
    ("ri.units.parse('4.85 mm/ms', 'velocity')", "it is 'm/s'"),
    ("ri.units.parse('0.5 ms/mm', 'inverse velocity')", "it is 's/m'"),
    ("ri.units.parse('36 kN/mm^2', 'pressure')", "it is 'GPa'"),
    ("ri.units.parse('3 N/cm^2', 'pressure')", "unknown unit 'N/cm^2'. Use one of Pa"),
    ("ri.units.in_si(1.0, 'N/mm^2')", "it is 'MPa'"),
    ("ri.units.parse('3 milimeter', 'length')", "Use one of m, cm, mm"),
    ("ri.Rod(0.4, area=1e-4, material='steel')", "such as materials.steel"),
    ("ri.Rod(0.4, area='1 cm^2', material=steel)", "units.parse('1 cm^2', 'area')"),
    ("ri.Rod(0.4, area='1 cm2', material=steel)", "perhaps 'cm^2' is meant"),
    ("ri.Wall('13 fps')", "perhaps 'ft/s' is meant"),
    ("ri.System([rod], gravity='1 g')", "standard gravity is '9.80665 m/s^2'"),
]
KEYWORDS = [
    ("ri.Rod(0.4, A=1e-4, material=steel)", "perhaps 'area' is meant"),
    ("ri.Rod(0.4, radius=1e-2, material=steel)", "give diameter, twice the radius"),
    ("ri.Rod(0.4, area=1e-4, E=2e11)", "perhaps 'material' is meant"),
    ("ri.Rod(0.4, area=1e-4, material=steel, v0=1)", "perhaps 'velocity' is meant"),
    ("ri.Rod(0.4, area=1e-4, material=steel, v=1.0)", "perhaps 'velocity' is meant"),
    ("ri.Rod(0.4, area=1e-4, material=steel, sped=1)", "use one of length, area"),
    ("ri.Rod(0.4, 1e-4, steel)", "name the others: area=, diameter=, material="),
    ("ri.Material('x', E=2e11, rho=7800)", "perhaps 'youngs_modulus' is meant"),
    ("ri.Material(youngs_modulus=2e11, density=7800)", "needs name; it takes name"),
    ("ri.Hertz(k=1e10)", "perhaps 'stiffness' is meant"),
    ("ri.Hertz(E=2e11, radius=0.05)", "or Hertz.from_radii(left_radius, right_"),
    ("ri.Hertz.from_radii(R1=0.05, R2=0.05)", "no argument 'R1'; use one of left_r"),
    ("ri.Hertz(1e9).stored(d=1e-6)", "Hertz.stored() has no argument 'd'"),
    ("ri.Cushion(stiffness=1e8, restitution=0.8)", "perhaps 'loading' is meant"),
    ("ri.Soil(Ru=1e5)", "perhaps 'resistance' is meant"),
    ("ri.SpringDashpot(1e6, c=1)", "perhaps 'damping' is meant"),
    ("ri.RigidMass(m=1)", "perhaps 'mass' is meant"),
    ("ri.System([rod, rod], gap=1e-3)", "perhaps 'gaps' is meant"),
    ("ri.System([rod, rod], g=9.81)", "perhaps 'gravity' is meant"),
    ("ri.solve(system, t_end=1e-3)", "perhaps 'until' is meant"),
    ("ri.solve(system, tol=1e-3)", "perhaps 'rtol' is meant"),
    ("ri.solve(system, dt=1e-6)", "leave it out, or give another"),
    ("ri.solve(system, method='front')", "must be one of 'auto', 'fronts'"),
    ("ri.sweep(family.system, threads=4)", "perhaps 'workers' is meant"),
    ("ri.sweep(family.system, also=['stress'])", '"largest_stress"'),
    ("ri.rigid.collide(1, 1, 1, 0, e=1)", "perhaps 'restitution' is meant"),
    ("ri.rigid.collide(1, 1, 1, 0)", "needs restitution; it takes m1, v1"),
    ("ri.plot.spacetime(solution, quantity='stress')", "perhaps 'field' is meant"),
    ("ri.plot.spacetime(solution, field='pressure')", "must be one of 'velocity'"),
    ("solution.velocity(body=1, position=0.5, t=0)", "perhaps 'x' is meant"),
    ("solution.velocity(1, 0.5)", "needs t; it takes body, x, t"),
    ("rod.replace(len=1)", "perhaps 'length' is meant"),
    ("setattr(rod, 'length', 3)", "make a new one with another length"),
    ("ri.format_case(system, 'x.toml')", "takes only case by position"),
    ("ri.solve(system, tmax=1e-3)", "perhaps 'until' is meant"),
    ("ri.sweep(system, vary={'x': [1, 2]})", "is an array in the system, such as Rod"),
    ("ri.sweep(system, length=[1, 2])", "is an array in the system, such as Rod"),
    ("ri.Rod(0.4, area=1e-4, density=7850)", "material=Material(name, youngs_modulus"),
    ("ri.Spring(1e6, 100)", "SpringDashpot(stiffness, damping) has a damping, too"),
    ("ri.Spring(1e6, loss=100)", "SpringDashpot(stiffness, damping) has a damping, to"),
    ("ri.explore(rod, rod)", "make one system, System([left, right])"),
]
SHAPES = [
    ("ri.System(rod, rod)", "must be a list of at least one rod"),
    ("ri.System([rod, ri.Wall])", "must be a Rod, a RigidMass or a Wall itself"),
    ("ri.System([rod, ri.Wall(), rod])", "make two systems of this one"),
    ("ri.System([rod, rod], gaps=1e-3)", "one entry for each neighbouring pair"),
    ("ri.System([rod, rod], contacts=ri.Hertz(1e9))", "must be a list with one entry"),
    ("ri.System([rod, rod], contacts=[ri.Hertz])", "must be a contact law itself"),
    ("ri.System([rod, rod], contacts='hertz')", "such as [Hertz(stiffness)], got"),
    ("ri.Rod([1, 2], area=[1, 2, 3], material=steel)", "area has shape (3,)"),
    ("ri.solve(rod, rod)", "must be a System, such as System([left, right])"),
    ("ri.solve([rod, rod])", "must be a System, such as System([left, right])"),
    ("ri.solve(family.system)", "solve all by sweep(system)"),
    ("ri.collide([rod, rod])", "needs right; it takes left, right"),
    ("solution.velocity(2, 0.5, 0)", "must be a whole number from 0 to 1"),
    ("solution.velocity(1, 1.5, 0)", "must lie in body 1, 0 to 1 m"),
    ("solution.stress(1, [0.1, 0.2], [0, 1e-4, 2e-4])", "ask for x[:, None] and t"),
    ("ri.plot.sweep(solution)", "such as rodimpact.sweep(family)"),
    ("ri.plot.energy(family)", "such as rodimpact.solve(system)"),
    ("ri.Signal([0, 1, 2], [0, 1])", "must be as many as values"),
]
COMMANDS = [
    ("", "choose one of box, run"),
    ("solve case.toml", "perhaps run is meant"),
    ("compare case.toml shot.csv --plot a.png", "--save FILE.png draws the comparison"),
    ("bearing case.toml --resistance 1kN --units us", "results are in SI units"),
    ("runn case.toml", "perhaps run is meant"),
    ("run", "arguments are required: CASE.toml"),
    ("run case.tml", "case.tml: cannot be read"),
    ("run cases.toml", "perhaps 'case.toml' is meant"),
    ("compare case.toml records.csv --gauge a=0:0.1", "perhaps 'record.csv' is meant"),
    ("run record.csv", "a case file is TOML (a record is read by"),
    ("help soil", "there is no text on 'soil'; `rodimpact help` lists all texts"),
    ("run case.toml --plt x.png", "perhaps '--plot' is meant"),
    ("run case.toml more.toml", "rodimpact run --help shows what it takes"),
    ("run case.toml --plot x.bmp", "must end in one of .png, .svg, .pdf"),
    ("run case.toml --until 1m", "'m' is a unit of length. Use one of s, ms"),
    ("run case.toml --method front", "choose from 'auto', 'fronts'"),
    ("run case.toml --dt 1us", "leave it out, or give another"),
    ("run case.toml --gauge 1:0.5", "such as incident=1:0.5"),
    ("sweep case.toml", "--vary bodies.0.length=0.05:1:200"),
    ("sweep case.toml --vary length=1:2:3", "perhaps one of bodies.0.length, bod"),
    ("plot case.toml", "rodimpact run CASE.toml --plot FILE draws a case"),
    ("help materials", "`rodimpact materials` lists them"),
    ("sweep case.toml --vary bodies.0.lenght=1:2:3", "perhaps 'bodies.0.length'"),
    ("sweep case.toml --vary bodies.0.length=1:2", "must be start:stop:count"),
    ("sweep case.toml --vary bodies.0.length=1s:2s:3", "Use one of m, cm, mm"),
    ("rigid --m1 1 --v1 0 --m2 1 --v2 1 -e 1", "body 1 is on the left"),
    ("rigid --m1 1 --v1 1 --m2 1 --v2 0 -e 2", "set --energy-release"),
    ("box --material stel", "choose from 'steel', 'aluminium'"),
    ("box --ratio 2", "must be above 0 and at most 1"),
    ("formula case.toml --symbols lenght", "perhaps 'length' is meant"),
    ("animate case.toml -o x.html", "must end in one of .gif, .mp4"),
    ("doctor steel", "leave it out: rodimpact doctor takes options only"),
    ("doctor --warmup", "perhaps '--warm' is meant"),
    ("--verison", "perhaps '--version' is meant"),
]
TABLE_OF_MATERIAL = "{density = 7850, youngs_modulus = 2e11}"
CASES = [  # a text of a case file, what stands in its place, and the answer
    ('"steel"', TABLE_OF_MATERIAL, "call the table [materials.NAME], and write NAME"),
    ("area =", "E = 2e11\narea =", "belongs to a table of the material"),
    ("area =", "density = 1\narea =", "belongs to a table of the material"),
    ("[[bodies]]", "gravity = '1 g'\n[[bodies]]", "is '9.80665 m/s^2'"),
    ("[[bodies]]", "[shaft]\n[[bodies]]", "as the table [bodies.shaft]"),
    ("[[bodies]]", "[[contacts]]\n[[contacts]]\n[[bodies]]", "1 in all, got 2"),
]


@pytest.fixture(scope="module")
def names():
    """{name: object} of the names that the guesses use."""
    steel = ri.materials.steel
    rod = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    right = ri.Rod(1.0, area=1e-4, material=steel)
    system = ri.System([rod, right])
    lengths = np.array([0.2, 0.4])
    area = ri.Steps([1e-4, 2e-4], at=[0.1])
    stepped = ri.Rod(0.4, area=area, material=steel, velocity=1.0)
    return {
        "ri": ri,
        "steel": steel,
        "rod": rod,
        "system": system,
        "solution": ri.solve(system),
        "smooth": ri.solve(system, method="characteristics"),
        "stepped": ri.System([stepped, right]),
        "family": ri.sweep(ri.System([rod.replace(length=lengths), right])),
        "rigid": ri.rigid.collide(1.0, 1.0, 1.0, 0.0, 1.0),
        "signal": ri.Signal([0.0, 1.0], [0.0, 1e-3]),
    }


@pytest.mark.parametrize(("guess", "remedy"), NAMES + UNITS + KEYWORDS + SHAPES)
def test_a_wrong_guess_in_python_is_answered_by_a_remedy(guess, remedy, names):
    with pytest.raises((AttributeError, LookupError, TypeError, ValueError)) as caught:
        eval(guess, dict(names))
    assert remedy in str(caught.value)


@pytest.mark.parametrize(("right", "wrong", "remedy"), CASES)
def test_a_wrong_entry_of_a_case_is_answered_by_a_remedy(right, wrong, remedy):
    """A case with one entry replaced by a wrong one is refused with the remedy."""
    assert right in UNEQUAL_RODS
    text = UNEQUAL_RODS.replace(right, wrong, 1)
    with pytest.raises(ri.InvalidModel) as caught:
        ri.parse_case(text, "case.toml")
    assert remedy in str(caught.value)


@pytest.mark.parametrize(("guess", "remedy"), COMMANDS)
def test_a_wrong_command_is_answered_by_a_remedy(
    guess, remedy, tmp_path, monkeypatch, capsys
):
    """The command runs in a folder with a case and a record; the answer is on standard
    error.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(UNEQUAL_RODS)
    (tmp_path / "record.csv").write_text("t,force\n0,1\n1,2\n")

    exit_status = main(shlex.split(guess))

    out, err = capsys.readouterr()
    answer = " ".join(err.split())  # without the ends of lines
    assert exit_status == 2
    assert out == ""
    assert remedy in answer
    assert "Traceback" not in err


def public_things():
    """Pairs (name, thing) of public functions and classes, below modules too.

    Errors, warnings and what lies in `units` are left out.
    """
    things = {}
    for name in ri.__all__:
        public = getattr(ri, name)
        if inspect.ismodule(public):
            for below in public.__all__:
                things[f"{name}.{below}"] = getattr(public, below)
        else:
            things[name] = public
    for name, public in things.items():
        is_error = inspect.isclass(public) and issubclass(public, Exception)
        if callable(public) and not is_error and not name.startswith("units."):
            yield name, public


def test_every_public_function_explains_a_wrong_argument():
    """Every public function and class that a user calls refuses an unknown argument by
    its name, or says that it takes none.
    """
    silent = []
    for name, call in public_things():
        if inspect.isclass(call) and not issubclass(call, Frozen):
            continue  # functions of the package make the objects of these classes
        with pytest.raises(TypeError) as caught:
            call(no_such_argument=1)
        sentence = str(caught.value)
        names_it = "has no argument 'no_such" in sentence
        says_there_is_none = "takes no arguments" in sentence
        if not names_it and not says_there_is_none:
            silent.append(name)
    assert silent == []


def test_every_public_class_has_a_hook_to_explain_a_missing_attribute():
    silent = []
    for name, kind in public_things():
        if inspect.isclass(kind) and not hasattr(kind, "__getattr__"):
            silent.append(name)
    assert silent == []


def test_a_missing_record_names_a_file_that_is_there(tmp_path):
    (tmp_path / "shot.csv").write_text("t,force\n0,1\n1,2\n")

    with pytest.raises(FileNotFoundError, match=r"perhaps '.*shot\.csv' is meant"):
        ri.read_signals(tmp_path / "shots.csv")


def test_results_that_an_object_does_not_have_are_missing_attributes(names):
    """So `hasattr`, and tools that ask for all attributes, get an answer."""
    rod = names["rod"]
    row = ri.System([rod, rod.replace(velocity=0.0), ri.Wall()])
    solution_of_two_contacts = ri.solve(row)
    outcome = solution_of_two_contacts.outcome
    family = names["family"]

    assert not hasattr(family, "dissipated")
    assert getattr(family, "sets", None) is None
    assert not hasattr(outcome, "impulse")
    assert not hasattr(outcome, "restitution")
    for result in (family, solution_of_two_contacts, outcome):
        assert "contacts" in dict(inspect.getmembers(result))
        assert copy.copy(result) is not result


def test_private_names_and_those_that_python_asks_for_get_no_hint(names):
    solution = names["solution"]
    assert not hasattr(solution, "__array__")
    with pytest.raises(AttributeError) as caught:
        _ = solution._private
    assert "perhaps" not in str(caught.value)


def test_a_property_that_fails_raises_its_own_error():
    """`explain_missing` does not replace an AttributeError that a property raises."""

    @explain_missing()
    class Broken:
        @property
        def value(self):
            raise AttributeError("the reason")

    with pytest.raises(AttributeError, match=r"^the reason$"):
        _ = Broken().value


def test_type_errors_inside_a_function_are_not_taken_for_wrong_arguments():
    """A function explains its unknown arguments; a TypeError raised in its body keeps
    its own message.
    """

    @explain_arguments
    def half(x):
        return x / 2

    with pytest.raises(TypeError, match="unsupported operand"):
        half("a")
    with pytest.raises(TypeError, match=r"half\(\) has no argument 'y'; use one of x"):
        half(y=1)


def test_a_hint_is_looked_for_only_when_an_error_is_shown(monkeypatch):
    """`hasattr`, and `getattr` with a default, take no time for hints."""
    rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    looked_for = []

    def hint(instance, name):
        looked_for.append((instance, name))
        return "why"

    monkeypatch.setattr(hints, "_attribute_hint", hint)

    assert not hasattr(rod, "lenght")
    assert getattr(rod, "lenght", None) is None
    assert looked_for == []
    with pytest.raises(AttributeError, match="why"):
        _ = rod.lenght
    assert looked_for == [(rod, "lenght")]
