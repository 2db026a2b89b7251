"""Functions of this package as JavaScript, so that the page computes with the same kernels.

What is translated is what has a template or a method below: numbers, text, lists, tables, named
tuples and records; loops and conditions; calls of functions that are translated too; constants,
nested lists and enums of modules. Values are the same, bit for bit, but for exp, logarithms, powers
and sums. All else is refused with its file and line. Where JavaScript means another thing,
page/python.js says what Python means, or throws. Whole numbers must stay below 2^53. A condition is
true, false or a number, no list; division by 0 gives what arrays give. Loops have no `else`, lists
are joined by unpacking, and no index from the end is assigned to: tests of the numbers find those.
"""

import ast
import builtins
import dataclasses
import inspect
import json
import math
import re
import textwrap
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping
from enum import Enum, EnumType
from functools import reduce
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

MOST = 1 << 53  # doubles hold whole numbers below
TEMPLATES = {
    "Break": "break;\n",
    "Continue": "continue;\n",
    "Return": "return {value};\n",
    "Expr": "{value};\n",
    "Assign": "{targets}={value};\n",
    "AnnAssign": "{target}={value};\n",
    "If": "if({?test}){\n{body}}else{\n{orelse}}\n",
    "While": "while({?test}){\n{body}}\n",
    "For": "for({target} of {iter}){\n{body}}\n",
    "IfExp": "({?test}?{body}:{orelse})",
    "List": "[{elts}]",
    "Tuple": "[{elts}]",
    "Starred": "...{value}",
    "Attribute": "{value}.{attr}",
    "Subscript": "{value}[{slice}]",
    "JoinedStr": "({values})",
    "FormattedValue": "py.format({value},{format_spec})",
    # operators; a space, as the number behind may have a sign
    "Add": "({left}+{right})",
    "Sub": "({left}- {right})",
    "Mult": "({left}*{right})",
    "Div": "({left}/{right})",
    "FloorDiv": "py.floordiv({left},{right})",
    "Mod": "py.mod({left},{right})",
    "BitXor": "py.xor({left},{right})",
    "LShift": "py.shl({left},{right})",
    "RShift": "py.shr({left},{right})",
    "Pow": "py.pow({left},{right})",
    "List Mult": "py.repeat({left},{right})",
    "Lt": "{left}<{right}",
    "LtE": "{left}<={right}",
    "Gt": "{left}>{right}",
    "GtE": "{left}>={right}",
    "Eq": "{left}==={right}",
    "NotEq": "{left}!=={right}",
    "In": "py.has({right},{left})",
    "NotIn": "!py.has({right},{left})",
    "Is": "{left}=={right}",
    "IsNot": "{left}!={right}",
    "Not": "!{?operand}",
    "USub": "(-{operand})",
    "And": " && ",
    "Or": " || ",
}
"""What nodes and operators become; with a question mark a part is a condition."""
SEPARATORS = {"elts": ",", "targets": "=", "values": "+"}
CALLS: dict[Any, str] = {
    abs: "Math.abs",
    int: "py.int",
    round: "py.round",
    sorted: "py.sorted",
    list: "Array.from",
    enumerate: "py.enumerate",
    zip: "py.zip",
    range: "py.range",
    bool: "py.truth",
    float: "Number",
    len: "{}.length",
    sum: "py.sum",
    math.fsum: "py.sum",
    any: "py.any",
    all: "py.all",
    max: "py.most",
    min: "py.least",
    isinstance: "py.isinstance",
    getattr: "{}[{}]",
    setattr: "{}[{}]={}",
    bisect_left: "py.bisect_left",
    bisect_right: "py.bisect_right",
    math.sqrt: "Math.sqrt",
    math.floor: "Math.floor",
    math.trunc: "Math.trunc",
    math.log: "Math.log",
    math.log10: "Math.log10",
    math.gcd: "py.gcd",
    math.frexp: "py.frexp",
    math.isfinite: "Number.isFinite",
    # of single numbers
    np.where: "py.where",
    np.minimum: "py.min",
    np.maximum: "py.max",
    np.floor: "Math.floor",
    np.abs: "Math.abs",
    np.exp: "Math.exp",
    np.expm1: "Math.expm1",
    np.arctanh: "Math.atanh",
    np.rint: "py.round",
    np.spacing: "py.spacing",
    np.isfinite: "Number.isFinite",
    np.any: "py.truth",
}
KINDS = {
    "float": "number",
    "str": "string",
    "dict": "object",
    "list": "array",
    "Steps": "object",
}
METHODS = {
    "append": "{}.push({})",
    "extend": "py.extend({},{})",
    "get": "py.get({},{})",
    "pop": "{}.pop()",
    "items": "Object.entries({})",
    "upper": "{}.toUpperCase()",
    "join": "{1}.join({0})",
}
ARRAYS = set(dir(np.ndarray)) - {"base", "mean"}
"""What arrays have and nothing in JavaScript, but for the names of fields of records."""


class Untranslatable(ValueError):
    """A function uses what is not translated; the message says what, and where."""


def javascript(
    roots: Iterable[Any],
    constants: Mapping[str, float] | None = None,
    known: Mapping[Any, str] | None = None,
) -> str:
    """Functions, and all of the package that they call, as JavaScript.

    Parameters
    ----------
    roots : iterable of functions
    constants : mapping of str to number, optional
        Values that stand in for those of modules, by name.
    known : mapping of functions to str, optional
        Functions that the page has under a name of its own.

    Raises
    ------
    Untranslatable
        At the first thing that is not translated.
    """
    program = _Program(constants or {}, {**CALLS, **(known or {})})
    for root in roots:
        program.name(root, root.__name__, root.__module__)
    texts = [
        _Translator(function, program).text() for function in program.functions
    ]  # they grow
    return "\n".join([*program.tables, *texts])


def field_names(record: Any) -> list[str]:
    """Names of the fields of a named tuple or a dataclass; none of anything else."""
    if isinstance(record, type) and dataclasses.is_dataclass(record):
        return [field.name for field in dataclasses.fields(record)]
    return list(getattr(record, "_fields", ()))


class _Program:
    """Functions with all that they need; `calls` are names of what JavaScript has."""

    def __init__(
        self, constants: Mapping[str, float], calls: Mapping[Any, str]
    ) -> None:
        self.constants, self.calls = constants, calls
        self.functions: list[FunctionType] = []
        self.tables: list[str] = []
        self._names: dict[int, str] = {}

    def name(self, thing: Any, name: str, module: str) -> str:
        """Name of a function, of a list of a module or of an empty record; it is written too.

        It stands behind those of its modules where another thing bears it.
        """
        if id(thing) in self._names:
            return self._names[id(thing)]
        parts = module.split(".")
        while name in self._names.values():
            name = f"{parts.pop()}_{name}"
        self._names[id(thing)] = name
        if isinstance(thing, FunctionType):
            self.functions.append(thing)
            return name
        if isinstance(thing, np.dtype):
            thing = {
                field: np.zeros(thing[field].shape).tolist()
                for field in thing.names or ()
            }
        self.tables.append(f"const {name}={json.dumps(thing, separators=(',', ':'))};")
        return name


class _Translator(ast.NodeVisitor):
    """Translates one function of a program."""

    def __init__(self, function: FunctionType, program: _Program) -> None:
        self.function, self.program = function, program
        lines, self.line = inspect.getsourcelines(function)
        tree: Any = ast.increment_lineno(
            ast.parse(textwrap.dedent("".join(lines))), self.line - 1
        )
        self.tree = tree.body[0]
        stored = {
            n.id
            for n in ast.walk(self.tree)
            if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
        }
        self.arguments = [n.arg for n in self.tree.args.args]
        self.local = stored | {*self.arguments}

    def text(self) -> str:
        """The function in JavaScript."""
        names = [f"{name}_" for name in self.arguments]
        for k, default in enumerate(reversed(self.tree.args.defaults), 1):
            names[-k] += f"={self.visit(default)}"
        own = ",".join(f"{name}_" for name in sorted(self.local - {*self.arguments}))
        name = self.program.name(
            self.function, self.function.__name__, self.function.__module__
        )
        body = self.tree.body[1 if ast.get_docstring(self.tree) else 0 :]
        begin = f"let {own};\n" if own else ""
        return (
            f"function {name}({','.join(names)}){{\n{begin}{self.part('body', body)}}}"
        )

    def visit(self, node: ast.AST) -> str:
        """Text of a node."""
        self.line = getattr(node, "lineno", self.line)
        try:
            return str(super().visit(node))
        except KeyError as missing:  # in a table above
            where = f"{inspect.getsourcefile(self.function)}:{self.line}"
            message = f"{where}: {missing.args[0]} is not translated to JavaScript"
            raise Untranslatable(message) from None

    def generic_visit(self, node: ast.AST) -> str:
        """Text of a node that needs a template only: its own, or that of its operator."""
        kind = type(getattr(node, "op", node)).__name__
        repeats = kind == "Mult" and isinstance(getattr(node, "left", None), ast.List)
        return self.filled("List Mult" if repeats else kind, node)

    def filled(self, kind: str, node: Any) -> str:
        """The template of a kind with the parts of a node."""

        def text(found: re.Match[str]) -> str:
            value = getattr(node, found[2])
            return self.truth(value) if found[1] else self.part(found[2], value)

        return re.sub(r"\{(\??)(\w+)\}", text, TEMPLATES[kind])

    def part(self, name: str, value: Any) -> str:
        """Text of what a node has under a name."""
        if isinstance(value, list):
            return SEPARATORS.get(name, "").join(map(self.visit, value))
        return self.visit(value) if isinstance(value, ast.AST) else value or ""

    def truth(self, value: ast.expr) -> str:
        """Text of a condition: true or false; a number is true unless it is 0."""
        sure = isinstance(value, ast.Compare | ast.BoolOp | ast.UnaryOp)
        return self.visit(value) if sure else f"py.truth({self.visit(value)})"

    # Statements -----------------------------------------------------------------------------------

    def visit_For(self, node: ast.For) -> str:
        match node.iter:
            case ast.Call(ast.Name("range"), bounds):
                target, *given = map(self.visit, [node.target, *bounds])
                start, stop, step = (
                    given if len(given) == 3 else [*["0", *given][-2:], "1"]
                )
                sign = ">" if "-" in step else "<"
                # a variable of its own: the loop's keeps its last value
                head = f"let _{target}={start},_end={stop};_{target}{sign}_end;_{target}+={step}"
                return f"for({head}){{\n{target}=_{target};\n{self.part('body', node.body)}}}\n"
        return self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> str:
        match node.targets, node.value:
            case [ast.Tuple(targets)], ast.Tuple(values):  # quicker than by a list
                held = ",".join(
                    f"_{i}={self.visit(value)}" for i, value in enumerate(values)
                )
                sent = "".join(f"{self.visit(x)}=_{i};" for i, x in enumerate(targets))
                return f"{{const {held};{sent}}}\n"
        return self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> str:
        value = self.visit(ast.BinOp(node.target, node.op, node.value))
        return f"{self.visit(node.target)}={value};\n"

    # Expressions ----------------------------------------------------------------------------------

    def known(self, node: ast.expr) -> Any:
        """What a name of a module, or an attribute of a module or an enum, stands for, or None."""
        constants, owner = self.program.constants, None
        match node:
            case ast.Name(name) if name not in self.local:
                held = self.function.__globals__
                return constants.get(
                    name, held.get(name, getattr(builtins, name, None))
                )
            case ast.Attribute(value, name):
                owner = self.known(value)
        if not isinstance(owner, ModuleType | Enum | EnumType):
            return None
        return constants.get(name, getattr(owner, name))

    def held(self, name: str, value: Any) -> str:
        """A value of a module: lists and tables by their name, all else as it is written."""
        if isinstance(value, list | dict | np.dtype):
            return self.program.name(value, name, self.function.__module__)
        if isinstance(value, type):
            return json.dumps(KINDS[value.__name__])
        if not isinstance(value, int | float | str) or (
            isinstance(value, int) and abs(value) >= MOST
        ):
            raise KeyError(f"the name {name}")
        return json.dumps(value)  # which has Infinity and NaN, as JavaScript

    def visit_Constant(self, node: ast.Constant) -> str:
        return "null" if node.value is None else self.held(repr(node.value), node.value)

    def visit_Name(self, node: ast.Name) -> str:
        return (
            f"{node.id}_"
            if node.id in self.local
            else self.held(node.id, self.known(node))
        )

    def visit_Attribute(self, node: ast.Attribute) -> str:
        value = self.known(node)
        if node.attr in ARRAYS and value is None:
            raise KeyError(f"the attribute {node.attr}")
        return (
            self.generic_visit(node) if value is None else self.held(node.attr, value)
        )

    def visit_Subscript(self, node: ast.Subscript) -> str:
        match node.slice:
            case ast.Slice(lower, upper):
                ends = self.visit(lower or ast.Constant(0)), self.part("upper", upper)
                return f"{self.visit(node.value)}.slice({','.join(ends)})"
            case ast.UnaryOp():
                return f"{self.visit(node.value)}.at({self.visit(node.slice)})"
        return self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> str:
        sign = TEMPLATES[type(node.op).__name__]
        return f"({sign.join(self.truth(x) for x in node.values)})"

    def visit_Compare(self, node: ast.Compare) -> str:
        sides = [node.left, *node.comparators]
        return "({})".format(
            " && ".join(
                self.filled(type(op).__name__, ast.BinOp(left, ast.Add(), right))
                for left, op, right in zip(sides, node.ops, sides[1:], strict=False)
            )
        )

    def visit_Dict(self, node: ast.Dict) -> str:
        entries = [
            f"...{self.visit(value)}"
            if key is None
            else f"[{self.visit(key)}]:{self.visit(value)}"
            for key, value in zip(node.keys, node.values, strict=True)
        ]
        return f"({{{','.join(entries)}}})"

    def visit_ListComp(self, node: ast.ListComp | ast.GeneratorExp) -> str:
        text = self.visit(node.elt)
        for i, loop in enumerate(reversed(node.generators)):
            item = self.visit(loop.target)
            kept = "".join(f".filter(({item})=>{self.truth(x)})" for x in loop.ifs)
            every = "flatMap" if i else "map"
            text = (
                f"Array.from({self.visit(loop.iter)}){kept}.{every}(({item})=>({text}))"
            )
        return text

    visit_GeneratorExp = visit_ListComp  # noqa: N815 - a name of ast

    def visit_Call(self, node: ast.Call) -> str:
        called, name, calls = (
            self.known(node.func),
            ast.unparse(node.func),
            self.program.calls,
        )
        given = [self.visit(x) for x in node.args]
        if any(word.arg != "strict" for word in node.keywords):
            raise KeyError("an argument by name")
        if called is None and isinstance(node.func, ast.Attribute):
            return METHODS[node.func.attr].format(
                self.visit(node.func.value), ",".join(given)
            )
        if called in (min, max) and len(given) > 1:
            return reduce(lambda text, other: f"py.{name}({text},{other})", given)
        if fields := field_names(called):
            given_fields = zip(fields, given, strict=False)  # the last have defaults
            return f"({{{','.join(map(':'.join, given_fields))}}})"
        if called in calls:
            text = calls[called]
        elif isinstance(called, FunctionType) and called.__module__.startswith(
            "rodimpact."
        ):
            text = self.program.name(called, called.__name__, called.__module__)
        else:
            raise KeyError(f"calling {name}")
        return text.format(*given) if "{" in text else f"{text}({','.join(given)})"
