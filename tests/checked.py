"""A debug build of what the page computes: the same functions on the page's clock, checked.

Every whole number that an operation makes must stay below 2^53, the largest that JavaScript has,
and no computed place in a list may count from its end.
"""

from __future__ import annotations

import ast
import sys
from types import ModuleType

from rodimpact.explorer.javascript import MOST, Program, tree_of


class _Checks(ast.NodeTransformer):
    """Has the result of every operation looked at."""

    def visit_BinOp(self, node):
        self.generic_visit(node)
        return ast.Call(ast.Name("_checked", ast.Load()), [node], [])

    def visit_AugAssign(self, node):
        value = self.visit(ast.BinOp(_loaded(node.target), node.op, node.value))
        return ast.Assign([node.target], value)


    def visit_Subscript(self, node):
        self.generic_visit(node)
        if isinstance(node.slice, ast.Call):  # computed, not written out
            node.slice = ast.Call(ast.Name("_place", ast.Load()), [node.slice], [])
        return node


def place(index):
    """The index; IndexError if it counts from the end of a list, which JavaScript does not."""
    if isinstance(index, int) and index < 0:
        raise IndexError(f"{index} is before the first")
    return index


def _loaded(target):
    text = ast.unparse(target)
    return ast.parse(text, mode="eval").body


def checked(value):
    """The value; OverflowError if the page could not hold it."""
    if isinstance(value, int) and abs(value) >= MOST:
        raise OverflowError(f"{value} is not below 2^53")
    return value


class Checked:
    """A module whose functions are checked, with these constants."""

    def __init__(self, space):
        vars(self).update(space)


def build(roots, constants, known):
    """Functions by name, checked, with these constants."""
    spaces, found, modules = {}, {}, {}
    for function in Program(roots, constants, known).texts:
        name = function.__module__
        space = spaces.setdefault(name, {**vars(sys.modules[name]), **constants})
        space |= {"_checked": checked, "_place": place}
        tree = ast.Module([_Checks().visit(tree_of(function))], [])
        exec(compile(ast.fix_missing_locations(tree), name, "exec"), space)
        found[function.__name__] = space[function.__name__]
    for space in spaces.values():
        for name, value in space.items():
            if isinstance(value, ModuleType) and value.__name__.startswith("rodimpact."):
                known = spaces.get(value.__name__, {**vars(value), **constants})
                space[name] = modules.setdefault(value.__name__, Checked(known))
        own = {name: made for name, made in found.items()
               if made.__module__ != space["__name__"] and name in space}
        space.update(own)
    return found
