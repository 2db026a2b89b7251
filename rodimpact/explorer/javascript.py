"""Translation of functions of this package to JavaScript, for the kernels of the page.

The translator knows the syntax that has a template or a method below: numbers, text,
lists, dictionaries, named tuples and records; loops and conditions; calls of functions
that are translated too; constants, nested lists and enums of modules. Other syntax is
refused with its file and line. Values are the same, bit for bit, except for exp,
logarithms, powers and sums.

If JavaScript has another meaning than Python, page/python.js does as Python does, or
throws. Whole numbers must stay below 2^53. A condition is true, false or a number, no
list. A division by 0 gives what arrays give. Loops have no `else`, lists are joined by
unpacking, and no index from the end is assigned to; tests of the numbers find such
code.
"""

import ast
import builtins
import dataclasses
import inspect
import json
import math
import re
import string
import textwrap
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Mapping
from enum import Enum, EnumType
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

MAX_WHOLE = 1 << 53
"""Doubles hold all whole numbers below this one."""
TEMPLATES = {
    "Break": "break;\n",
    "Continue": "continue;\n",
    "Return": "return {value};\n",
    "Expr": "{value};\n",
    "Assign": "{targets}={value};\n",
    "AnnAssign": "{target}={value};\n",
    "If": "if({?test}){\n{body}}\n",
    "If Else": "if({?test}){\n{body}}else{\n{orelse}}\n",
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
"""JavaScript of the nodes and operators of `ast`, by their names.

A placeholder is the name of a field of the node; one with a question mark is a
condition.
"""
SEPARATORS = {"elts": ",", "targets": "=", "values": "+"}
"""Text between the items of a field that is a list, by the name of the field."""
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
    # NumPy's functions have single numbers as arguments
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
"""JavaScript of functions: a name, or a template for the arguments.

`py` is the library of the page, in page/python.js.
"""
TYPES = {
    "float": "number",
    "str": "string",
    "dict": "object",
    "list": "array",
    "Steps": "object",
}
"""Names of types for `py.isinstance`, by their names in Python."""
METHODS = {
    "append": "{}.push({})",
    "extend": "py.extend({},{})",
    "get": "py.get({},{})",
    "pop": "{}.pop()",
    "items": "Object.entries({})",
    "upper": "{}.toUpperCase()",
    "join": "{1}.join({0})",
}
"""JavaScript of methods, a template for the object and the arguments."""
ARRAY_ATTRIBUTES = set(dir(np.ndarray)) - {"base", "mean"}
"""Attributes of arrays, which JavaScript lacks.

The two left out are also names of fields of records.
"""


class Untranslatable(ValueError):
    """A function uses syntax that is not translated; the message has file and line."""


def javascript(
    roots: Iterable[Any],
    constants: Mapping[str, float] | None = None,
    provided: Mapping[Any, str] | None = None,
) -> str:
    """Translate functions, and all functions of the package that they call.

    Parameters
    ----------
    roots : iterable of functions
    constants : mapping of str to number, optional
        Values of constants in the page, by the name that they have in their module.
    provided : mapping of functions to str, optional
        Names in the page of functions that it has in its own way.

    Returns
    -------
    str
        JavaScript: the tables, then the functions.

    Raises
    ------
    Untranslatable
        At the first syntax that is not translated.
    """
    calls = dict(CALLS)
    if provided is not None:
        calls.update(provided)
    program = _Program(constants or {}, calls)
    for root in roots:
        program.name(root, root.__name__, root.__module__)  # queues the function
    texts = []
    # While a function is translated, the functions that it calls are appended.
    for function in program.functions:
        texts.append(_Translator(function, program).text())
    return "\n".join([*program.tables, *texts])


def field_names(record: Any) -> list[str]:
    """Names of the fields of a class of named tuples or a dataclass; [] for others."""
    if isinstance(record, type) and dataclasses.is_dataclass(record):
        return [field.name for field in dataclasses.fields(record)]
    return list(getattr(record, "_fields", ()))


class _Program:
    """Functions that are to be translated, with the tables that they need."""

    def __init__(
        self, constants: Mapping[str, float], calls: Mapping[Any, str]
    ) -> None:
        """Keep the constants and calls; no function is queued yet."""
        self.constants = constants  # values in the page, by name
        self.calls = calls  # JavaScript of functions that are not translated
        self.functions: list[FunctionType] = []
        self.tables: list[str] = []  # statements that declare tables
        self._names: dict[int, str] = {}  # names by the id of the object

    def name(self, value: Any, name: str, module: str) -> str:
        """Name in JavaScript of a function, or of a list, dictionary or dtype.

        An object that is known keeps its name. A new function is queued for
        translation, any other new object is declared as a table. If another object has
        the name already, the new one is prefixed with the names of its modules, the
        last one first, until it is unique.
        """
        if id(value) in self._names:
            return self._names[id(value)]
        modules = module.split(".")
        while name in self._names.values():
            name = f"{modules.pop()}_{name}"
        self._names[id(value)] = name
        if isinstance(value, FunctionType):
            self.functions.append(value)
        else:
            table = json.dumps(_plain_table(value), separators=(",", ":"))
            self.tables.append(f"const {name}={table};")
        return name


def _plain_table(value: Any) -> Any:
    """A list or dictionary as it is; a dtype as a dictionary of zeros by field.

    A field that is an array has a list of zeros.
    """
    if not isinstance(value, np.dtype):
        return value
    record = {}
    for field in value.names or ():
        record[field] = np.zeros(value[field].shape).tolist()
    return record


def _short_name(k: int) -> str:
    """Name of variable number k of a function: a_ to z_, then a1_ to z1_ and so on.

    Because of the underscore no name is a reserved word of JavaScript.
    """
    number, letter = divmod(k, len(string.ascii_lowercase))
    digits = str(number) if number > 0 else ""
    return f"{string.ascii_lowercase[letter]}{digits}_"


class _Translator(ast.NodeVisitor):
    """Translation of one function of a program."""

    def __init__(self, function: FunctionType, program: _Program) -> None:
        """Parse the source of the function, and give its variables short names.

        Long names would take a tenth of the page.
        """
        self.function = function
        self.program = program
        # `line` is the number in the file of the line that is being translated.
        lines, self.line = inspect.getsourcelines(function)
        module: Any = ast.parse(textwrap.dedent("".join(lines)))
        ast.increment_lineno(module, self.line - 1)  # numbers of lines as in the file
        self.tree = module.body[0]  # the definition of the function
        self.arguments = [argument.arg for argument in self.tree.args.args]
        # Short names of arguments and variables, by those in Python; the arguments come
        # first.
        self.local: dict[str, str] = {}
        for name in self.arguments:
            self.local[name] = _short_name(len(self.local))
        for node in ast.walk(self.tree):
            # a name that is assigned to
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                self.local.setdefault(node.id, _short_name(len(self.local)))

    def text(self) -> str:
        """The whole function in JavaScript: head, variables, body.

        Variables are declared at the top. Default values of arguments stay; the
        docstring is left out.
        """
        arguments = [self.local[name] for name in self.arguments]
        defaults = self.tree.args.defaults  # those of the last arguments
        first_with_default = len(arguments) - len(defaults)
        for i, default in enumerate(defaults, first_with_default):
            arguments[i] += f"={self.visit(default)}"
        variables = list(self.local.values())[len(arguments) :]
        declaration = ""
        if variables:
            declaration = f"let {','.join(variables)};\n"
        name = self.program.name(
            self.function, self.function.__name__, self.function.__module__
        )
        statements = self.tree.body
        if ast.get_docstring(self.tree):
            statements = statements[1:]
        body = self.part("body", statements)
        return f"function {name}({','.join(arguments)}){{\n{declaration}{body}}}"

    def visit(self, node: ast.AST) -> str:
        """JavaScript of a node, by its method or by `generic_visit`.

        Untranslatable is raised, with file and line, if the node has none.
        """
        self.line = getattr(node, "lineno", self.line)
        try:
            return str(super().visit(node))
        except KeyError as missing:  # a table above lacks the syntax or the name
            location = f"{inspect.getsourcefile(self.function)}:{self.line}"
            message = f"{location}: {missing.args[0]} is not translated to JavaScript"
            raise Untranslatable(message) from None

    def generic_visit(self, node: ast.AST) -> str:
        """Text of a node that has no method of its own, by its template.

        An operation has the template of its operator, such as "Add".
        """
        kind = type(getattr(node, "op", node)).__name__
        if kind == "Mult" and isinstance(getattr(node, "left", None), ast.List):
            kind = "List Mult"  # [0] * n repeats a list
        if kind == "If" and getattr(node, "orelse", None):
            kind = "If Else"
        return self.filled(kind, node)

    def filled(self, kind: str, node: Any) -> str:
        """The template of `kind`, filled with the fields of a node.

        A placeholder such as {body} is replaced by the text of the field `body`, and
        {?test} by that of the field `test` as a condition.
        """

        def text(placeholder: re.Match[str]) -> str:
            """Text of the field that a placeholder names."""
            question_mark, name = placeholder.groups()
            value = getattr(node, name)
            if question_mark:
                return self.truth(value)
            return self.part(name, value)

        return re.sub(r"\{(\??)(\w+)\}", text, TEMPLATES[kind])

    def part(self, name: str, value: Any) -> str:
        """Text of a field of a node: a list of nodes, a node, a name, or None.

        Nodes in a list are joined by the separator of the field. A name is its own
        text, the text of None is "".
        """
        if isinstance(value, list):
            return SEPARATORS.get(name, "").join(map(self.visit, value))
        if isinstance(value, ast.AST):
            return self.visit(value)
        return value or ""

    def truth(self, value: ast.expr) -> str:
        """Text of a condition, whose value in JavaScript is true or false.

        `py.truth` makes numbers true unless they are 0. Comparisons, `not`, `and` and
        `or` give true or false already.
        """
        text = self.visit(value)
        is_negation = isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.Not)
        if is_negation or isinstance(value, ast.Compare | ast.BoolOp):
            return text
        return f"py.truth({text})"

    # Statements -----------------------------------------------------------------------

    def visit_For(self, node: ast.For) -> str:
        """Text of a loop: a counting loop over `range`, else `for ... of` over a list.

        A counting loop counts in a variable of its own. So after the loop the variable
        of Python has its last value, and not the first one beyond the range.
        """
        match node.iter:
            case ast.Call(ast.Name("range"), arguments):
                pass  # the pattern has given `arguments` their name
            case _:
                return self.generic_visit(node)
        # range(stop), range(start, stop) or range(start, stop, step)
        target = self.visit(node.target)
        texts = list(map(self.visit, arguments))
        start = "0"
        step = "1"
        if len(texts) == 1:
            stop = texts[0]
        else:
            start = texts[0]
            stop = texts[1]
        if len(texts) == 3:
            step = texts[2]
        comparison = "<"
        if "-" in step:  # steps are constants, so the text shows their sign
            comparison = ">"
        counter = f"_{target}"
        # `let` gives each loop its own _end, also a loop inside another.
        declaration = f"let {counter}={start},_end={stop}"
        head = f"{declaration};{counter}{comparison}_end;{counter}+={step}"
        body = self.part("body", node.body)
        return f"for({head}){{\n{target}={counter};\n{body}}}\n"

    def visit_Assign(self, node: ast.Assign) -> str:
        """Text of an assignment; `a, b = x, y` is done item by item, which is quicker.

        All values are computed before the first item is assigned, as in Python.
        """
        match node.targets, node.value:
            case [ast.Tuple(targets)], ast.Tuple(values):
                pass  # the pattern has set `targets` and `values`
            case _:
                return self.generic_visit(node)
        constants = []
        assignments = ""
        for i, value in enumerate(values):
            constants.append(f"_{i}={self.visit(value)}")
        for i, target in enumerate(targets):
            assignments += f"{self.visit(target)}=_{i};"
        return f"{{const {','.join(constants)};{assignments}}}\n"

    def visit_AugAssign(self, node: ast.AugAssign) -> str:
        """Text of `x += y` as x=(x+y), also with another operator."""
        value = self.visit(ast.BinOp(node.target, node.op, node.value))
        return f"{self.visit(node.target)}={value};\n"

    # Expressions ----------------------------------------------------------------------

    def known(self, node: ast.expr) -> Any:
        """Value that a name or an attribute has outside the function.

        It is the value of a name of the function's module or of Python, or of an
        attribute of a module or an enum. A constant of the program with this name
        replaces it. The result is None for variables of the function, their fields and
        methods, and all other expressions.
        """
        constants = self.program.constants
        match node:
            case ast.Name(name) if name not in self.local:
                if name in constants:
                    return constants[name]
                in_builtins = getattr(builtins, name, None)
                return self.function.__globals__.get(name, in_builtins)
            case ast.Attribute(value, name):
                owner = self.known(value)
            case _:
                return None
        if not isinstance(owner, ModuleType | Enum | EnumType):
            return None
        if name in constants:
            return constants[name]
        return getattr(owner, name)

    def literal(self, name: str, value: Any) -> str:
        """Text of a value of a module that has this name.

        Lists, dictionaries and dtypes are declared as tables of the program; the text
        is the name of the table. A type is the text in `TYPES` that `py.isinstance`
        takes. Numbers and texts are literals. KeyError is raised for a whole number
        that doubles do not hold, for types not in `TYPES`, and for all other values.
        """
        if isinstance(value, list | dict | np.dtype):
            return self.program.name(value, name, self.function.__module__)
        if isinstance(value, type):
            return json.dumps(TYPES[value.__name__])  # in quotation marks
        if isinstance(value, int) and abs(value) >= MAX_WHOLE:
            raise KeyError(f"the name {name}")
        if not isinstance(value, int | float | str):
            raise KeyError(f"the name {name}")
        return json.dumps(value)  # Infinity and NaN are those of JavaScript

    def visit_Constant(self, node: ast.Constant) -> str:
        """Text of a number, a text, or null."""
        if node.value is None:
            return "null"
        return self.literal(repr(node.value), node.value)

    def visit_Name(self, node: ast.Name) -> str:
        """Short name of a variable, or text of a value of the module."""
        if node.id in self.local:
            return self.local[node.id]
        return self.literal(node.id, self.known(node))

    def visit_Attribute(self, node: ast.Attribute) -> str:
        """Text of a value of a module or enum, or of a field of a record.

        KeyError is raised for an attribute of arrays.
        """
        value = self.known(node)
        if value is not None:
            return self.literal(node.attr, value)  # a table gets the name `node.attr`
        if node.attr in ARRAY_ATTRIBUTES:
            raise KeyError(f"the attribute {node.attr}")
        return self.generic_visit(node)  # a field: the template "Attribute"

    def visit_Subscript(self, node: ast.Subscript) -> str:
        """Text of x[i], x.slice(i,j) for x[i:j], or x.at(-i) for x[-i].

        A slice without a start begins at 0. KeyError is raised for a slice with a step.
        """
        match node.slice:
            case ast.Slice(lower, upper, None):  # either bound may be None, too
                start = self.visit(lower or ast.Constant(0))
                stop = self.part("upper", upper)
                return f"{self.visit(node.value)}.slice({start},{stop})"
            case ast.UnaryOp():  # an index from the end
                return f"{self.visit(node.value)}.at({self.visit(node.slice)})"
        return self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> str:
        """Text of conditions joined by `and` or `or`: true or false."""
        sign = TEMPLATES[type(node.op).__name__]
        return f"({sign.join(map(self.truth, node.values))})"

    def visit_Compare(self, node: ast.Compare) -> str:
        """Text of a comparison in brackets; that of a < b < c is (a<b && b<c)."""
        comparisons = []
        left = node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            # The template needs a node with the fields `left` and `right`; the operator
            # of this node does not matter.
            pair = ast.BinOp(left, ast.Add(), right)
            comparisons.append(self.filled(type(operator).__name__, pair))
            left = right
        return f"({' && '.join(comparisons)})"

    def visit_Dict(self, node: ast.Dict) -> str:
        """Text of a dictionary as an object; `**other` in it becomes ...other."""
        entries = []
        for key, value in zip(node.keys, node.values, strict=True):
            if key is None:  # **value
                entries.append(f"...{self.visit(value)}")
            else:
                entries.append(f"[{self.visit(key)}]:{self.visit(value)}")
        return f"({{{','.join(entries)}}})"

    def visit_ListComp(self, node: ast.ListComp | ast.GeneratorExp) -> str:
        """Text of a comprehension or generator as a list made by `map` and `filter`.

        The last of several loops maps; each loop before it flattens the lists of the
        loops inside.
        """
        text = self.visit(node.elt)
        method = "map"
        for loop in reversed(node.generators):
            item = self.visit(loop.target)
            filters = ""
            for condition in loop.ifs:
                filters += f".filter(({item})=>{self.truth(condition)})"
            items = f"Array.from({self.visit(loop.iter)}){filters}"
            text = f"{items}.{method}(({item})=>({text}))"
            method = "flatMap"  # for the loops around this one
        return text

    visit_GeneratorExp = visit_ListComp  # noqa: N815 - a name of ast

    def visit_Call(self, node: ast.Call) -> str:
        """Text of a call of a method, of min and max, of a record, or of a function.

        A record becomes an object with its fields. KeyError is raised for an argument
        by name, except `strict` of `zip`, which is left out; and for methods and
        functions that the page does not have.
        """
        called = self.known(node.func)
        arguments = list(map(self.visit, node.args))
        for keyword in node.keywords:
            if keyword.arg != "strict":
                raise KeyError("an argument by name")
        if called is None and isinstance(node.func, ast.Attribute):  # a method
            owner = self.visit(node.func.value)
            return METHODS[node.func.attr].format(owner, ",".join(arguments))
        name = ast.unparse(node.func)
        if called in (min, max) and len(arguments) > 1:
            # py.min and py.max of the page take two numbers: min(a, b, c) is
            # min(min(a, b), c).
            text = arguments[0]
            for argument in arguments[1:]:
                text = f"py.{name}({text},{argument})"
            return text
        fields = field_names(called)
        if fields:
            entries = []
            # Fields without an argument have defaults, which the page does not need.
            for field, argument in zip(fields, arguments, strict=False):
                entries.append(f"{field}:{argument}")
            return f"({{{','.join(entries)}}})"
        text = self.name_of_function(called, name)
        if "{" in text:  # a template, not a name
            return text.format(*arguments)
        return f"{text}({','.join(arguments)})"

    def name_of_function(self, function: Any, name: str) -> str:
        """Name in JavaScript of a function that is called, or its template.

        A function in the program's `calls` has its entry there. Another function of
        this package is queued for translation. KeyError is raised for all others;
        `name` is their name in the message.
        """
        if function in self.program.calls:
            return self.program.calls[function]
        if not isinstance(function, FunctionType):
            raise KeyError(f"calling {name}")
        if not function.__module__.startswith("rodimpact."):
            raise KeyError(f"calling {name}")
        return self.program.name(function, function.__name__, function.__module__)
