"""What the documentation shows is what happens."""

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

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PARTS = [
    part.name
    for part in pkgutil.iter_modules(rodimpact.__path__)
    if part.name[0] != "_"
]
LONG = {"design", "explorer", "fitting", "piles", "plot", "records", "results"}
QUICK = [part for part in PARTS if part not in LONG]


def examples_in(module):
    assert doctest.testmod(module).failed == 0
    for part in pkgutil.iter_modules(getattr(module, "__path__", ())):
        examples_in(importlib.import_module(f"{module.__name__}.{part.name}"))


@pytest.mark.parametrize("part", few_of(PARTS, QUICK))
def test_examples_in_docstrings(part):
    examples_in(importlib.import_module(f"rodimpact.{part}"))


def test_the_example_of_the_package():
    assert doctest.testmod(rodimpact).failed == 0


def test_the_program_of_the_readme_prints_what_it_says(tmp_path, monkeypatch):
    program = re.search(
        r"```python\n(import rodimpact.*?)```\n\n```text\n(.*?)```", README, re.S
    )
    printed = io.StringIO()
    names = {}
    with contextlib.redirect_stdout(printed):
        exec(program[1], names)
    assert printed.getvalue() == program[2]
    monkeypatch.chdir(tmp_path)
    for more in re.findall(r"```python\n(.*?)```", README, re.S)[1:]:
        exec(more, names)
    for picture in ("row", "family"):
        assert (tmp_path / f"{picture}.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.stem
)
def test_whoever_follows_a_page_twice_may_write_its_files_again(page):
    calls = re.findall(
        r"(?:plot\.save|\.save|to_csv)\(.*\"[^\"]+\.\w+\"[^)]*\)",
        page.read_text(encoding="utf-8"),
    )
    assert [call for call in calls if "force=True" not in call] == []


def test_links_and_pictures_of_the_readme_exist():
    for target in re.findall(r"\]\(([^)]+)\)", README):
        if not target.startswith("http"):
            assert (ROOT / target).exists(), target


def test_every_command_of_the_readme_exists():
    from rodimpact.cli import COMMANDS

    shown = set(re.findall(r"^rodimpact (\w+)", README, re.M))
    assert shown == set(COMMANDS)


def test_the_manual_lists_every_public_name():
    listed = re.findall(
        r"^   (\w+[.\w]*)$", (ROOT / "docs" / "api.md").read_text("utf-8"), re.M
    )
    names = {
        name
        for name in rodimpact.__all__
        if not inspect.ismodule(getattr(rodimpact, name))
    }
    for module in (
        rodimpact.plot,
        rodimpact.design,
        rodimpact.rigid,
        rodimpact.theory,
        rodimpact.units,
        rodimpact.waves,
    ):
        names |= {
            f"{module.__name__.removeprefix('rodimpact.')}.{name}"
            for name in module.__all__
        }
    assert set(listed) >= names


def public_names():
    """Names of the manual's list, with what they stand for."""
    listed = (ROOT / "docs" / "api.md").read_text("utf-8")
    for name in re.findall(r"^   (\w+[.\w]*)$", listed, re.M):
        public = rodimpact
        for part in name.split("."):
            public = getattr(public, part)
        yield name, public


def test_every_public_name_has_an_example():
    without = [
        name
        for name, public in public_names()
        if ">>>" not in (inspect.getdoc(public) or "")
    ]
    assert without == []


def test_the_manual_is_no_longer_than_it_may_be():
    """Words of the README, of tutorials without their code, and of the verdicts."""

    def prose(page):
        return re.sub(
            r"```.*?```", "", (ROOT / page).read_text("utf-8"), flags=re.S
        ).split()

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
        assert len(prose(f"docs/{name}.md")) <= 1500, name
    assert len((ROOT / "validation" / "README.md").read_text("utf-8").split()) <= 1000


def test_figures_of_the_theory_are_drawn_by_their_functions():
    spec = importlib.util.spec_from_file_location(
        "figures", ROOT / "docs" / "theory_figures.py"
    )
    figures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(figures)
    shown = re.findall(
        r"\(figures/theory_(\w+)\.svg\)", (ROOT / "docs" / "theory.md").read_text()
    )
    assert shown == [draw.__name__ for draw in figures.FIGURES]
    assert all(
        (figures.FOLDER / f"theory_{name}.svg").stat().st_size < 60_000
        for name in shown
    )
    texts = {
        name: (figures.FOLDER / f"theory_{name}.svg").read_text("utf-8")
        for name in shown
    }
    for draw in figures.FIGURES[:7]:
        labels = [text.get_text() for text in draw().figure.findobj(Text)]
        words = [label for label in labels if label.isalpha() and label.isascii()]
        assert all(word in texts[draw.__name__] for word in words), draw.__name__


def blocks(kind):
    """Blocks of the manual that are shown and not run when it is built."""
    return [
        pytest.param(text, id=f"{page.stem} {i}")
        for page in sorted((ROOT / "docs").glob("*.md"))
        for i, text in enumerate(
            re.findall(rf"^```{kind}\n(.*?)^```", page.read_text("utf-8"), re.S | re.M)
        )
    ]


@pytest.mark.parametrize("block", blocks("sh"))
def test_commands_of_the_manual_take_their_options(block, monkeypatch):
    from rodimpact.cli import main
    from rodimpact.cli.exit_status import CommandResult

    for line in block.replace("\\\n", " ").splitlines():
        program, *arguments = shlex.split(line.partition(">")[0], comments=True) or [""]
        if program == "rodimpact":
            command = importlib.import_module(f"rodimpact.cli.{arguments[0]}")
            monkeypatch.setattr(command, "run", lambda given: CommandResult("", 0))
            assert main(arguments) == 0


@pytest.mark.parametrize("block", blocks("python"))
def test_python_of_the_manual_runs(block, tmp_path, monkeypatch):
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
    bar = SimpleNamespace(n=0, update=lambda n: None)
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
    """Public functions, classes and methods, by name."""
    for name, public in public_names():
        yield name, public
        if inspect.isclass(public):
            for method_name, method in vars(public).items():
                if method_name[0] != "_" and inspect.isfunction(method):
                    yield f"{name}.{method_name}", method


def test_help_shows_signatures_that_can_be_read():
    """No annotation is longer than a line of a terminal."""
    for name, call in public_calls():
        if inspect.isclass(call) and issubclass(call, Exception):
            continue  # Python knows no signature of its own errors
        signature = inspect.signature(call)
        for parameter in signature.parameters.values():
            annotation = inspect.formatannotation(parameter.annotation)
            assert len(annotation) <= 80, (name, parameter.name)
