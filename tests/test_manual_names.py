"""Every file and every name that the manual mentions exists.

Words between backquotes are looked up: names of the package, names of files, commands
with their options, and, on the page for contributors, every identifier.
"""

import importlib
import re
import shlex
from pathlib import Path

import pytest

import rodimpact
from rodimpact.cli import COMMANDS

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FOLDERS = (
    "",
    "rodimpact",
    "rodimpact/methods",
    "docs",
    "docs/_static",
    "tests",
    "validation",
)
"""Folders from which the manual names files."""
SUFFIXES = r"py|pyi|md|toml|css|js|cff|html"
EXAMPLES = {
    "CASE.toml",
    "FILE.html",
    "FILE.toml",
    "PAGE.html",
    "box/index.html",
    "case.toml",
    "plot/velocities.py",
    "run.toml",
    "tests/test_mine.py",
}
"""Files that a user makes."""
OBJECTS = {
    "solution": rodimpact.Solution,
    "outcome": rodimpact.Outcome,
    "result": rodimpact.SweepResult,
    "plane": rodimpact.Atlas,
    "fit": rodimpact.Fit,
    "rod": rodimpact.Rod,
}
"""Classes of the variables that the pages use."""
CONTRIBUTING = (ROOT / "docs" / "contributing.md").read_text("utf-8")


def code_spans(text):
    """Pieces of code between single backquotes, without blocks and roles."""
    without_blocks = re.sub(r"```.*?```", "", text, flags=re.S)
    without_roles = re.sub(r"\{\w+\}`[^`]+`", "", without_blocks)
    pieces = re.findall(r"`([^`]+)`", without_roles)
    return [" ".join(piece.split()) for piece in pieces]  # on one line


def attribute_exists(path):
    """Whether a dotted path leads, from the package on, to a module or an attribute."""
    public = rodimpact
    for name in path.split("."):
        fields = getattr(public, "__annotations__", {})
        if name in fields:
            return True
        if not hasattr(public, name):
            return is_set_by_constructor(public, name)
        public = getattr(public, name)
    return True


def is_set_by_constructor(public, name):
    """Whether the docstring of a class lists an attribute of this name."""
    docstring = getattr(public, "__doc__", None) or ""
    entry = rf"^    [\w, ]*\b{name}\b[\w, ]*( :|$)"
    return re.search(entry, docstring, re.M) is not None


def mentions(find):
    """Pairs of the name of a page and a thing that `find` finds in its text, sorted,
    each once.
    """
    pairs = []
    for page in PAGES:
        for mention in sorted(set(find(page.read_text("utf-8")))):
            pairs.append((page.stem, mention))
    return pairs


def each_page(find):
    """Parameters, with ids, for a test of each thing that `find` finds on each page."""
    cases = []
    for page, mention in mentions(find):
        cases.append(pytest.param(mention, id=f"{page}: {mention}"[:80]))
    return cases


def names_of_package(text):
    """Dotted names of things of the package, without "rodimpact.", from roles and from
    code between backquotes.
    """
    roles = re.findall(r"\{(?:func|class|meth|mod|attr)\}`[^`<]*?<?~?([\w.]+)>?`", text)
    names = [role.removeprefix("rodimpact.") for role in roles]
    for span in code_spans(text):
        for path in re.findall(r"\bri\.([A-Za-z_][\w.]*)", span):
            names.append(path.rstrip("."))
        named = re.match(r"rodimpact\.([A-Za-z_][\w.]*)", span)
        if named and not span.endswith((".light", ".dark")):
            names.append(named[1])
    return names


def test_names_of_the_package_exist():
    """Each dotted name of the package that a page of the manual mentions leads to
    something.
    """
    missing = []
    for page, path in mentions(names_of_package):
        if not attribute_exists(path):
            missing.append((page, path))
    assert missing == []


def attributes_of_objects(text):
    """Texts like `solution.outcome`, of the variables in `OBJECTS`."""
    attributes = []
    variables = "|".join(OBJECTS)
    for span in code_spans(text):
        if span.startswith("["):  # a table of a case file
            continue
        attributes += re.findall(rf"\b((?:{variables})\.[a-z_]+)", span)
    return attributes


@pytest.mark.parametrize("path", each_page(attributes_of_objects))
def test_attributes_of_objects_exist(path):
    """An attribute that the manual writes as `variable.name` belongs to the class in
    `OBJECTS`.
    """
    variable, name = path.split(".")
    kind = OBJECTS[variable]
    fields = getattr(kind, "__annotations__", {})
    assert hasattr(kind, name) or name in fields or is_set_by_constructor(kind, name)


def files(text):
    """Names of files and folders: code between backquotes that ends with a known suffix
    or a slash, and targets of links that are not web addresses, without anchors.
    """
    file = rf"[\w./-]+\.({SUFFIXES})"
    folder = r"[\w.-]+(/[\w.-]+)*/"  # it ends with a slash
    names = []
    for span in code_spans(text):
        if re.fullmatch(file, span) or re.fullmatch(folder, span):
            names.append(span)
    links = re.findall(r"\]\(([^)#\s]+)", text)
    names += [link for link in links if "://" not in link]
    return names


def is_a_file(name):
    """Whether a page may name a file: it exists, or is that of an example."""
    return name in EXAMPLES or any(
        (ROOT / folder / name).exists() for folder in FOLDERS
    )


def test_files_exist():
    """Each file or folder that a page of the manual names exists, or is one of the
    examples that a user makes.
    """
    missing = []
    for page, name in mentions(files):
        if not is_a_file(name):
            missing.append((page, name))
    assert missing == []


def commands(text):
    """Pieces of code that call the program."""
    return [span for span in code_spans(text) if re.match(r"rodimpact( |$)", span)]


@pytest.mark.parametrize("span", each_page(commands))
def test_commands_and_their_options_exist(span, capsys):
    """A `rodimpact` command that a page mentions exists, and its help names each option
    of the mention. Mentions without a command, or with the word COMMAND, pass.
    """
    _, *words = shlex.split(span)
    if not words or not words[0].isalpha():  # no command, but options or a file
        return
    name, *arguments = words
    if name.isupper():  # `rodimpact COMMAND`
        return
    assert name in COMMANDS
    command = importlib.import_module(f"rodimpact.cli.{name}")
    with pytest.raises(SystemExit):
        parser_of(command).parse_args(["--help"])
    help_text = capsys.readouterr().out
    for argument in arguments:
        if argument.startswith("-"):
            option, *_ = argument.split("=")
            assert option in help_text


def parser_of(command):
    """Parser of a command."""
    from rodimpact.cli import _new_parser

    parser = _new_parser(prog="rodimpact", description="")
    command.add_arguments(parser)
    return parser


def sources():
    """All text in which a name of the page for contributors may stand."""
    texts = []
    for folder in ("rodimpact", "tests", "validation", "docs", ".ci"):
        for path in sorted((ROOT / folder).rglob("*")):
            is_source = path.suffix in (".py", ".pyi", ".toml", ".css", ".js", "")
            if path.is_file() and is_source and path.name != Path(__file__).name:
                texts.append(path.read_text("utf-8"))
    for name in ("pyproject.toml", ".git-blame-ignore-revs"):
        texts.append((ROOT / name).read_text("utf-8"))
    return "\n".join(texts)


def test_identifiers_on_the_page_for_contributors_stand_in_the_sources():
    """Every identifier in code on this page occurs in the sources; commands, patterns
    and files are left out.
    """
    words = set(re.findall(r"\w+", sources()))
    unknown = []
    for span in code_spans(CONTRIBUTING):
        if re.match(r"(git|npx|pytest|rodimpact|python|grep|pip|playwright|\.)", span):
            continue
        if "*" in span or span in files(CONTRIBUTING):
            continue
        for identifier in re.findall(r"[A-Za-z_]\w{2,}", span):
            if identifier not in words:
                unknown.append(identifier)
    assert unknown == []


def test_the_table_of_files_on_the_page_for_contributors_names_modules():
    """Each name in the table of `methods/` on this page is a folder or module there."""
    _, _, after_heading = CONTRIBUTING.partition("Within `methods/`:")
    table, _, _ = after_heading.partition("\n\n`ri.solve`")
    rows = re.findall(r"^\| (`.*?) \|", table, re.M)
    assert len(rows) > 5
    for row in rows:
        for name in re.findall(r"`(\w+)/?`", row):
            path = ROOT / "rodimpact" / "methods" / name
            assert path.is_dir() or path.with_suffix(".py").exists(), name
