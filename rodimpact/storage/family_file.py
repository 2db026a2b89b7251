"""A family in a file: a JSON document of its system, and the arrays in it.

An object of the model is described by its class and the parameters of its constructor.
The constructor checks them again when the file is read. Arrays of one type are joined
in one flat array, the column of this type; in the document an array is replaced by its
position in the column.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ..model import System
from ..model.bodies import BODIES, Material, Segment
from ..model.ends import ENDS
from ..model.frozen import Frozen
from ..model.laws import CONTACT_LAWS
from ..model.profiles import Polynomials, Samples, Steps
from ..model.shaft import SHAFTS
from .writing import Arrays

MODEL_CLASSES: tuple[Any, ...] = (
    System,
    Material,
    Segment,
    Polynomials,
    Samples,
    Steps,
    *BODIES.values(),
    *CONTACT_LAWS.values(),
    *ENDS.values(),
    *SHAFTS.values(),
)
CLASSES: dict[str, Any] = {kind.__name__: kind for kind in MODEL_CLASSES}
"""Classes of the model by their names in a document."""
NOT_IN_JSON = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
"""Numbers that JSON does not have, by the words that stand for them."""


class _Describer:
    """Describes objects as JSON, and collects their arrays."""

    def __init__(self) -> None:
        self.columns = defaultdict[str, list[Any]](list)  # flat arrays by type
        self.sizes = Counter[str]()  # number of entries of each column
        # Array and its position, by the id of the array. The array is kept, so that no
        # other array gets the same id.
        self.places: dict[int, tuple[Any, dict[str, Any]]] = {}

    def describe(self, value: Any) -> Any:
        """Description, ready for JSON, of a value with all its items, recursively.

        Infinity and nan become words, and tuples become lists. A mapping or an object
        of the model becomes a dict with the key "class". An array becomes its position
        in a column, see `place_of`. Other values are returned unchanged.
        """
        if isinstance(value, np.ndarray):
            return self.place_of(value)
        if isinstance(value, list | tuple):
            return list(map(self.describe, value))
        if isinstance(value, float) and not math.isfinite(value):
            return str(float(value))
        if isinstance(value, str) and value in NOT_IN_JSON:
            # A text such as the name "inf" would be read as a number.
            return {"class": "str", "text": value}
        if isinstance(value, Mapping):
            items = list(value.items())  # pairs, since all keys of JSON are texts
            return {"class": "dict", "items": self.describe(items)}
        if isinstance(value, Frozen):
            return self.describe_object(value)
        return value

    def describe_object(self, value: Frozen) -> dict[str, Any]:
        """Description of an object of the model: its class and its parameters.

        The parameters are the arguments of its constructor. InvalidModel if a law of a
        system is a function.
        """
        if isinstance(value, System):
            value.check_file()  # raises for a law that is a function
        described: dict[str, Any] = {"class": type(value).__name__}
        for name, entry in value._parameters().items():
            described[name] = self.describe(entry)
        return described

    def place_of(self, array: Any) -> dict[str, Any]:
        """Position of an array in the column of its type: column, first index, shape.

        The first call with an array adds it to the end of its column. Later calls with
        the same object return the same position.
        """
        if id(array) not in self.places:
            column = array.dtype.str[1:]  # "f8" of "<f8", without the byte order
            position = {
                "array": column,
                "start": self.sizes[column],
                "shape": list(array.shape),
            }
            self.places[id(array)] = (array, position)
            self.columns[column].append(array.ravel())
            self.sizes[column] += array.size
        _, position = self.places[id(array)]
        return position


def describe(content: Any) -> tuple[dict[str, Any], Arrays]:
    """Document and arrays from which `restore` makes an equal object.

    The document is a dict ready for JSON. All arrays of one type are joined in one flat
    array, the column of this type; its key is the type, such as "f8". InvalidModel is
    raised for a system with a law that is a function.
    """
    describer = _Describer()
    document = {"content": describer.describe(content)}
    arrays = {}
    for name, parts in describer.columns.items():
        arrays[name] = np.concatenate(parts)
    return document, arrays


def restore(document: Mapping[str, Any], arrays: Arrays) -> Any:
    """The object that `describe` described.

    The constructors of the model make the objects in it, and check them again. Arrays
    in it are views of those in `arrays`. Any other document raises an error of any
    class.
    """

    @cache
    def array_at(column: str, start: int, *shape: int) -> Any:
        """Array at a position of a column; the same object at each call."""
        stop = start + math.prod(shape)
        return arrays[column][start:stop].reshape(shape)

    def restored(value: Any) -> Any:
        """The value that `_Describer.describe` described."""
        if isinstance(value, list):
            return list(map(restored, value))
        if isinstance(value, str):
            return NOT_IN_JSON.get(value, value)  # number of a word, or the text
        if not isinstance(value, dict):
            return value
        if "array" in value:
            return array_at(value["array"], value["start"], *value["shape"])
        name = value["class"]
        if name == "str":
            return value["text"]
        if name == "dict":
            return dict(restored(value["items"]))
        parameters = {}
        for parameter, entry in value.items():
            if parameter != "class":
                parameters[parameter] = restored(entry)
        return CLASSES[name](**parameters)

    return restored(document["content"])
