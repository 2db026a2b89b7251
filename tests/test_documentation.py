"""What the documentation shows is what happens."""

import argparse
import contextlib
import doctest
import importlib
import importlib.util
import inspect
import io
import pkgutil
import re
import shlex
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from exhaustive import few_of
from matplotlib.text import Text

import rodimpact
from rodimpact.cli import COMMANDS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PARTS = [
    part.name
    for part in pkgutil.iter_modules(rodimpact.__path__)
    if part.name[0] != "_"
]
LONG = {
    "design",
    "explorer",
    "fitting",
    "methods",
    "model",
    "piles",
    "plot",
    "records",
    "results",
    "running",
}
QUICK = [part for part in PARTS if part not in LONG]


def assert_examples_hold(module):
    """Run the examples in the docstrings of a module and of all modules below it."""
    assert doctest.testmod(module).failed == 0
    for part in pkgutil.iter_modules(getattr(module, "__path__", ())):
        below = importlib.import_module(f"{module.__name__}.{part.name}")
        assert_examples_hold(below)


@pytest.mark.parametrize("part", few_of(PARTS, QUICK))
def test_examples_in_docstrings(part):
    assert_examples_hold(importlib.import_module(f"rodimpact.{part}"))


def test_the_example_of_the_package():
    assert doctest.testmod(rodimpact).failed == 0


def test_the_programs_of_the_readme_print_what_it_says_and_write_pictures(
    tmp_path, monkeypatch
):
    """The first program of the README prints the text below it; all further ones run in
    an empty folder and write two pictures of more than 10 kB.
    """
    program_and_output = re.search(
        r"```python\n(import rodimpact.*?)```\n\n```text\n(.*?)```", README, re.S
    )
    program, output = program_and_output.groups()
    printed = io.StringIO()
    names = {}
    with contextlib.redirect_stdout(printed):
        exec(program, names)
    assert printed.getvalue() == output
    monkeypatch.chdir(tmp_path)
    _, *further_programs = re.findall(r"```python\n(.*?)```", README, re.S)
    for further_program in further_programs:
        exec(further_program, names)
    for picture in ("row", "family"):
        assert (tmp_path / f"{picture}.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.stem
)
def test_whoever_follows_a_page_twice_may_write_its_files_again(page):
    """Every call that writes a file says `force=True`."""
    calls = re.findall(
        r"(?:plot\.save|\.save|to_csv)\(.*\"[^\"]+\.\w+\"[^)]*\)",
        page.read_text(encoding="utf-8"),
    )
    assert [call for call in calls if "force=True" not in call] == []


def test_links_and_pictures_of_the_readme_exist():
    for target in re.findall(r"\]\(([^)]+)\)", README):
        if not target.startswith("http"):
            assert (ROOT / target).exists(), target


def test_the_readme_shows_every_command_and_no_other():
    from rodimpact.cli import COMMANDS

    shown = set(re.findall(r"^rodimpact (\w+)", README, re.M))
    assert shown == set(COMMANDS)


def test_the_manual_lists_every_public_name():
    """All public names of the package and of six of its modules are listed in the
    manual.
    """
    names = set()
    for name in rodimpact.__all__:
        if not inspect.ismodule(getattr(rodimpact, name)):
            names.add(name)
    for module_name in ("plot", "design", "rigid", "theory", "units", "waves"):
        module = getattr(rodimpact, module_name)
        for name in module.__all__:
            names.add(f"{module_name}.{name}")
    assert {name for name, _ in public_names()} >= names


def public_names():
    """Pairs of a name in the list of the manual and the object that it stands for."""
    listed = (ROOT / "docs" / "api.md").read_text("utf-8")
    for name in re.findall(r"^   (\w+[.\w]*)$", listed, re.M):
        public = rodimpact
        for part in name.split("."):
            public = getattr(public, part)
        yield name, public


def test_every_name_of_the_manual_has_an_example():
    without_example = []
    for name, public in public_names():
        docstring = inspect.getdoc(public) or ""
        if ">>>" not in docstring:
            without_example.append(name)
    assert without_example == []


def test_the_manual_is_no_longer_than_it_may_be():
    """The README has at most 900 words, each tutorial without its code 1500, and the
    page of verdicts 1000.
    """
    assert len(README.split()) <= 900
    assert len(README.splitlines()) < 150
    for name in (
        "start",
        "student",
        "experimenter",
        "reductions",
        "engineer",
        "researcher",
        "teacher",
    ):
        text = (ROOT / "docs" / f"{name}.md").read_text("utf-8")
        prose = re.sub(r"```.*?```", "", text, flags=re.S)
        assert len(prose.split()) <= 1500, name
    verdicts = (ROOT / "validation" / "README.md").read_text("utf-8")
    assert len(verdicts.split()) <= 1000


@pytest.mark.parametrize("count", few_of([2, 7], [2]))
def test_figures_of_the_theory_are_committed_with_the_words_of_their_functions(count):
    """The page on theory shows the figures of all its functions, each file below 60 kB.
    The words that the first `count` functions draw are in their files.
    """
    spec = importlib.util.spec_from_file_location(
        "figures", ROOT / "docs" / "theory_figures.py"
    )
    figures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(figures)
    shown = re.findall(
        r"\(figures/theory_(\w+)\.svg\)", (ROOT / "docs" / "theory.md").read_text()
    )
    assert shown == [draw.__name__ for draw in figures.FIGURES]
    committed = {}
    for name in shown:
        file = figures.FOLDER / f"theory_{name}.svg"
        assert file.stat().st_size < 60_000
        committed[name] = file.read_text("utf-8")
    for draw in figures.FIGURES[:count]:
        labels = [text.get_text() for text in draw().figure.findobj(Text)]
        words = [label for label in labels if label.isalpha() and label.isascii()]
        for word in words:
            assert word in committed[draw.__name__], draw.__name__


def blocks(kind):
    """Cases for `parametrize`: blocks of the manual in a language, which are shown and
    not run when it is built.
    """
    cases = []
    for page in sorted((ROOT / "docs").glob("*.md")):
        text = page.read_text("utf-8")
        blocks_of_page = re.findall(rf"^```{kind}\n(.*?)^```", text, re.S | re.M)
        for i, block in enumerate(blocks_of_page):
            cases.append(pytest.param(block, id=f"{page.stem} {i}"))
    return cases


@pytest.mark.parametrize("block", blocks("sh"))
def test_commands_of_the_manual_take_their_options(block, monkeypatch):
    """Each `rodimpact` command of a block of the manual is parsed, with its `run`
    replaced by one that does nothing; `main` returns 0.
    """
    from rodimpact.cli import main
    from rodimpact.cli.exit_status import CommandResult

    def run_nothing(args):
        return CommandResult("", 0)

    lines = block.replace("\\\n", " ").splitlines()  # a backslash joins two lines
    for line in lines:
        before_redirection, *_ = line.split(">")
        words = shlex.split(before_redirection, comments=True)
        if words and words[0] == "rodimpact":
            _, *arguments = words
            command = importlib.import_module(f"rodimpact.cli.{arguments[0]}")
            monkeypatch.setattr(command, "run", run_nothing)
            assert main(arguments) == 0


@pytest.mark.parametrize("block", blocks("python"))
def test_python_of_the_manual_runs(block, tmp_path, monkeypatch):
    """A block of Python of the manual is executed in an empty folder with a case file,
    with `ri`, `np`, `family` and `tqdm` defined; functions named `test_...` in it are
    called.
    """
    monkeypatch.chdir(tmp_path)
    rods = [
        rodimpact.Rod(
            np.array([0.2, 0.4]),
            area=1e-4,
            material=rodimpact.materials.steel,
            velocity=1.0,
        ),
        rodimpact.Wall(),
    ]
    family = rodimpact.System(rods)
    Path("case.toml").write_text(rodimpact.format_case(family[0]), "utf-8")
    bar = SimpleNamespace(n=0, update=lambda n: None)  # stands for one of tqdm
    names = {
        "ri": rodimpact,
        "np": np,
        "family": family,
        "tqdm": lambda total: contextlib.nullcontext(bar),
    }
    exec(block, names)
    for name, value in list(names.items()):
        if name.startswith("test_"):  # a page on tests shows one
            value()


@pytest.mark.parametrize("block", blocks("toml"))
def test_case_files_of_the_manual_are_read(block):
    if block.startswith("schema") and "[[bodies]]" in block:
        assert rodimpact.parse_case(block).system.bodies
    else:
        assert tomllib.loads(block)


def public_calls():
    """Yield pairs of a dotted name and a public function, class or method of a class,
    of all that the manual lists.
    """
    for name, public in public_names():
        yield name, public
        if inspect.isclass(public):
            for method_name, method in vars(public).items():
                if method_name[0] != "_" and inspect.isfunction(method):
                    yield f"{name}.{method_name}", method


def test_no_annotation_in_help_is_longer_than_a_line_of_a_terminal():
    for name, call in public_calls():
        if inspect.isclass(call) and issubclass(call, Exception):
            continue  # Python knows no signature of its own errors
        signature = inspect.signature(call)
        for parameter in signature.parameters.values():
            annotation = inspect.formatannotation(parameter.annotation)
            assert len(annotation) <= 80, (name, parameter.name)


def test_the_manual_names_every_command_that_reads_a_case_file():
    """Every command with an argument `case` is named in the first paragraph of the page
    on case files.
    """
    text = (ROOT / "docs" / "input.md").read_text(encoding="utf-8")
    first_paragraph = text[text.index("A case file describes") : text.index("```toml")]
    readers = []
    for name in COMMANDS:
        parser = argparse.ArgumentParser()
        importlib.import_module(f"rodimpact.cli.{name}").add_arguments(parser)
        if any(action.dest == "case" for action in parser._actions):
            readers.append(name)

    assert "bearing" in readers
    for name in readers:
        assert re.search(rf"`(rodimpact )?{name}`", first_paragraph), name
