"""Classes of settings, read from their source: nothing is imported, so nothing is compiled.

To import a planner takes half a second, most of it numba's; to read all of them takes some
hundredths.
"""

import ast
import importlib.util
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, TypeAlias

Env: TypeAlias = Mapping[str, Any]
"""Names of loops, and what they stand for."""


class _Unknown(Exception):
    """What an expression comes to is known only to who runs it."""


@dataclass(frozen=True)
class Field:
    """A field of a class of settings.

    Parameters
    ----------
    name : str
        Its name.
    type : str
        Its annotation.
    meaning : str
        What the class's docstring says of it; empty if nothing.
    range : str
        What its checks call right, or else what its type takes.
    inner : SettingsClass or None
        The class of its own settings, if it is a group of some.
    """

    name: str
    type: str
    meaning: str
    range: str
    inner: "SettingsClass | None"


class Module:
    """A module's source.

    Parameters
    ----------
    name : str
        Its dotted name.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.tree = ast.parse(_file(name).read_text("utf-8"))

    @cached_property
    def _own(self) -> dict[str, ast.AST]:
        classes = {node.name: node for node in self.tree.body if isinstance(node, ast.ClassDef)}
        return {**classes, **dict(_assigned(self.tree.body))}

    @cached_property
    def _imported(self) -> dict[str, tuple[str, str]]:
        return {
            alias.asname or alias.name: (node.module, alias.name)
            for node in self.tree.body
            if isinstance(node, ast.ImportFrom) and node.module
            for alias in node.names
        }

    def find(self, name: str) -> tuple["Module", ast.AST] | None:
        """Find what a name stands for, also in the module that it is imported from."""
        if name in self._own:
            return self, self._own[name]
        where, original = self._imported.get(name, ("", ""))
        if where.partition(".")[0] in ("", "typing", "dataclasses", "collections"):
            return None
        return module(where).find(original)

    def settings(self, name: str) -> "SettingsClass | None":
        """Give a dataclass of settings; None if the name stands for none."""
        found = self.find(name)
        if found is None or not isinstance(found[1], ast.ClassDef):
            return None
        home, node = found[0], found[1]
        marks = [ast.unparse(each) for each in node.decorator_list]
        return SettingsClass(home, node) if any("dataclass" in each for each in marks) else None

    def value(self, node: ast.AST, env: Env) -> Any:
        """Work out a constant, or the text that a message will be; raises _Unknown."""
        match node:
            case ast.Constant(value=value):
                return value
            case ast.Name(id=name) if name in env:
                return env[name]
            case ast.Name(id=name) if found := self.find(name):
                return found[0].value(found[1], {})
            case ast.Attribute(value=ast.Name(id=name), attr=attribute) if name in self._imported:
                inner = module(".".join(self._imported[name]))
                if found := inner.find(attribute):
                    return found[0].value(found[1], {})
            case ast.Tuple(elts=items) | ast.List(elts=items):
                return [each for item in items for each in self._items(item, env)]
            case ast.Dict(keys=keys):
                return [self.value(key, env) for key in keys if key is not None]
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
                return _OPERATIONS[type(op)](self.value(left, env), self.value(right, env))
            case ast.Call(func=ast.Attribute(value=glue, attr="join"), args=[items]):
                return self.value(glue, env).join(map(str, self.value(items, env)))
            case ast.JoinedStr(values=parts):
                return _without_echo("".join(self._part(part, env) for part in parts))
        raise _Unknown

    def _items(self, item: ast.AST, env: Env) -> list[Any]:
        if isinstance(item, ast.Starred):
            found: list[Any] = self.value(item.value, env)
            return found
        return [self.value(item, env)]

    def _part(self, part: ast.AST, env: Env) -> str:
        """Give a part of a message; what is known only later by its name."""
        if isinstance(part, ast.FormattedValue):
            try:
                value = self.value(part.value, env)
            except _Unknown:
                name = ast.unparse(part.value).replace("self.", "")
                if not name.replace(" - 1", "").isidentifier():
                    raise
                return name
            return ", ".join(value) if isinstance(value, list) else str(value)
        return str(self.value(part, env))


def _file(name: str) -> Path:
    """Find a module's file. Python would import the packages that the module lies in."""
    top, *rest = name.split(".")
    spec = importlib.util.find_spec(top)
    assert spec is not None, name
    if not rest and spec.origin is not None:
        return Path(spec.origin)
    places = [Path(place, *rest) for place in spec.submodule_search_locations or ()]
    files = [file for place in places for file in (place / "__init__.py", Path(f"{place}.py"))]
    return next(file for file in files if file.is_file())


def _assigned(lines: Iterable[ast.AST]) -> Iterator[tuple[str, ast.AST]]:
    """Give the names that lines assign something to, also several at once, and what."""
    for node in lines:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                yield name, value
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.AST() as value):
                yield name, value
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)):
                for each, item in zip(names, values, strict=False):
                    if isinstance(each, ast.Name):
                        yield each.id, item


_OPERATIONS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Pow: lambda a, b: a**b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.LShift: lambda a, b: a << b,
}


def _without_echo(text: str) -> str:
    """Say once what a message says by name and by value: "to max_epochs, max_epochs"."""
    return re.sub(r"\b(\w+),? \1\b", r"\1", text)


@lru_cache
def module(name: str) -> Module:
    """Read a module's source, once."""
    return Module(name)


class SettingsClass:
    """A dataclass of settings, its bases included.

    Parameters
    ----------
    home : Module
        Where it stands.
    node : ast.ClassDef
        The class.
    """

    def __init__(self, home: Module, node: ast.ClassDef) -> None:
        self.home, self.node = home, node

    @cached_property
    def _bases(self) -> list["SettingsClass"]:
        names = [base.id for base in self.node.bases if isinstance(base, ast.Name)]
        return [found for name in names if (found := self.home.settings(name))]

    @cached_property
    def said(self) -> str:
        """The first sentence of its docstring."""
        text = ast.get_docstring(self.node) or ""
        return " ".join(text.partition("\n\n")[0].split())

    @cached_property
    def meanings(self) -> dict[str, str]:
        """Field -> what the docstring says of it, in the numpy convention."""
        found = {name: text for base in self._bases for name, text in base.meanings.items()}
        part = (ast.get_docstring(self.node) or "").partition("Parameters\n----------\n")[2]
        part = re.split(r"\n\n(?=\w+\n-+\n)", part)[0]
        for entry in re.finditer(r"^(\w[\w, ]*) : .*\n((?:[ ]+.*\n?|\n(?=[ ]))+)", part, re.M):
            text = " ".join(entry[2].split())
            found |= {name.strip(): text for name in entry[1].split(",")}
        return found

    @cached_property
    def ranges(self) -> dict[str, str]:
        """Field -> what its checks call right."""
        found = {name: text for base in self._bases for name, text in base.ranges.items()}
        return found | ranges_in(self.home, self.node)

    @cached_property
    def fields(self) -> dict[str, Field]:
        """Its fields, by name, in their order."""
        found = {name: field for base in self._bases for name, field in base.fields.items()}
        for line in self.node.body:
            if not (isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name)):
                continue
            kind, name = ast.unparse(line.annotation), line.target.id
            if kind.startswith("ClassVar") or line.value is not None:
                continue
            inner = self.home.settings(kind) if kind.isidentifier() else None
            right = "settings of its own" if inner else self.ranges.get(name) or right_for(kind)
            found[name] = Field(name, kind, self.meanings.get(name, ""), right, inner)
        return found

    def mapping(self, name: str) -> dict[str, "SettingsClass"]:
        """Give a mapping to classes that a field without a setting holds, such as ``shapes``."""
        given = dict(_assigned(self.node.body)).get(name)
        if not isinstance(given, ast.Dict):
            return {}
        pairs = zip(given.keys, given.values, strict=True)
        classes = {ast.literal_eval(key): self.home.settings(ast.unparse(value))
                   for key, value in pairs if key is not None}  # fmt: skip
        return {key: value for key, value in classes.items() if value is not None}


def ranges_in(home: Module, node: ast.AST) -> dict[str, str]:
    """Find what checks within a class or a module call right: setting -> text.

    They are calls of `gapath.errors.require` and of a `gapath.errors.Checks` named check.
    """
    found: dict[str, list[str]] = {}
    for name, text in _checks(home, node, {}):
        if text not in found.setdefault(name.rpartition(".")[2], []):
            found[name.rpartition(".")[2]].append(text)
    return {name: "; ".join(texts) for name, texts in found.items()}


def _checks(home: Module, node: ast.AST, env: Env) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
        try:
            values = home.value(node.iter, env)
        except _Unknown:
            values = []
        for value in values:
            for line in node.body:
                yield from _checks(home, line, {**env, node.target.id: value})
        return
    if isinstance(node, ast.FunctionDef):
        env = {**env, **dict(_locals(home, node))}
    if isinstance(node, ast.Call):
        with suppress(_Unknown):
            match ast.unparse(node.func), node.args:
                case "check.whole", [name, *ends]:
                    least, most = (home.value(end, env) for end in ends)
                    yield home.value(name, env), f"an integer from {least} to {most}"
                case ("check", [name, _, right]) | ("require", [_, name, _, right]):
                    yield str(home.value(name, env)), str(home.value(right, env))
    for inner in ast.iter_child_nodes(node):
        yield from _checks(home, inner, env)


def _locals(home: Module, function: ast.FunctionDef) -> Iterator[tuple[str, Any]]:
    """Give the names of a function that stand for constants."""
    for name, node in _assigned(function.body):
        with suppress(_Unknown):
            yield name, home.value(node, {})


def right_for(kind: str) -> str:
    """Say what a type takes, for a setting without a check."""
    known = [_TYPES[each] for each in re.split(r" \| ", kind) if each in _TYPES]
    if "Planner" in kind or not known:
        return "a planner: the name of its YAML as base, and values that replace its own"
    return ", or ".join(known)


_TYPES = {
    "bool": "true or false",
    "str": "text",
    "int": "an integer",
    "float": "a number",
    "list[int]": "a list of integers",
    "list[str]": "a list of texts",
    "None": "null",
}
