"""Collisions of elastic rods: exact waves, unilateral contact, and restitution.

>>> import rodimpact as ri
>>> left = ri.Rod(length=0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> right = ri.Rod(length=1.0, area=1e-4, material=ri.materials.steel)
>>> round(ri.collide(left, right).restitution, 12)
0.4
"""

from importlib import import_module

from .version import __version__ as __version__

_HOME: dict[str, str] = {}
"""Module of each public name, from lines ``from .model.bodies import Rod as Rod``."""
with open(f"{__path__[0]}/__init__.pyi", encoding="utf-8") as _stub:
    for _line in _stub:
        _words = _line.split()
        if _words[:1] == ["from"]:
            # Word 1 is the module, word 3 the name; a module itself comes from ".".
            _HOME[_words[3]] = _words[1]

__all__ = sorted(_HOME)


def _in_notebook(result: object) -> str:
    """HTML of a result in a notebook; pictures are imported only when one is shown."""
    from .plot.notebook import html_of

    return html_of(result)


def __getattr__(name: str) -> object:
    """Import a public name or module on first use, and keep it in this module.

    AttributeError for a name that is not public. After the first name that is no
    module, notebooks show results as pictures.
    """
    if name not in _HOME:
        raise _missing(name)
    if _HOME[name] == ".":  # a module: Python itself keeps it as an attribute
        return import_module(f".{name}", __name__)
    value = getattr(import_module(_HOME[name], __name__), name)
    from .results import notebook

    notebook.html = _in_notebook
    globals()[name] = value
    return value


def _missing(name: str) -> AttributeError:
    """The error of a name that is not public; it names the one that may be meant.

    There is no such hint for names that begin with an underscore and for modules of the
    package.
    """
    from importlib.util import find_spec  # takes longer than all of this module

    # Python asks for names with an underscore, and for modules before it imports them.
    if name.startswith("_") or find_spec(f".{name}", __name__) is not None:
        return AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .hints import missing_name

    modules = {}
    for module, home in _HOME.items():
        if home == ".":
            modules[module] = import_module(f".{module}", __name__).__all__
    return missing_name(__name__, name, __all__, **modules)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
