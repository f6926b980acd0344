"""Change kernels one place at a time, and tell which changes no test notices: `make mutants`.

Without the compiler kernels are functions of Python. One pytest has collected all tests; for each
mutant it is forked, what was changed is put where the functions and constants are, so that whoever
imported them has it, and the tests that call the function are run until one fails. No file is
written. A mutant that runs out of its time counts as killed.
"""

import argparse
import ast
import collections
import importlib.abc
import importlib.util
import json
import os
import random
import resource
import sys
import time
import types
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, settings

ROOT = Path(__file__).parents[2]
KERNELS = ROOT / "gapath" / "kernels"
PLANNERS = [f"tests/planners/test_{name}.py" for name in ("bspline_ga", "row_column_ga")]

LEFT_OUT = {"jit", "kg18/evaluation", "kg18/field_lanes", "kg18/lanes", "kg18/vectors"}
LEFT_OUT |= {"cuda/compiler", "cuda/evolution"}
"""The decorator, vectors, which only the compiler understands, and what a GPU or its simulator runs
in a process of its own."""

SLOW, BUDGET = 5, 5
"""Seconds of computing for a test, else it is left out, and for a mutant's tests: those that call
the fewest kernels go first, of one with many parameters one before the others' second."""
FEW = 20
"""Examples by hypothesis of a test that would be left out."""
MEMORY = 8 << 30
LEAST = 10
"""Mutants of each module, if it has as many."""

BOTH_WAYS = "Add Sub, LShift RShift, BitAnd BitOr, And Or, Eq NotEq, Is IsNot, Mult FloorDiv"
ONE_WAY = "Div Mult, Mod FloorDiv, BitXor BitOr, Lt LtE GtE, LtE Lt Gt, Gt GtE LtE, GtE Gt Lt"
OPERATORS = {
    getattr(ast, old): [getattr(ast, name) for name in new]
    for old, *new in (
        *(words.split() for words in (BOTH_WAYS + ", " + ONE_WAY).split(",")),
        *(words.split()[::-1] for words in BOTH_WAYS.split(",")),
    )
}
NOT_RUN = {"annotation", "returns", "decorator_list"}


def one_more(node):
    return ast.BinOp(node, ast.Add(), ast.Constant(1))


def other_results(value, annotation):
    """Give results that are not the function's, by the type that it says."""
    match annotation:
        case ast.Name("int" | "float"):
            yield one_more(value)
        case ast.Name("bool"):
            yield ast.UnaryOp(ast.Not(), value)
        case ast.Subscript(ast.Name("tuple"), ast.Tuple(kinds)) if isinstance(value, ast.Tuple):
            for i, (one, kind) in enumerate(zip(value.elts, kinds, strict=False)):
                for other in other_results(one, kind):
                    yield ast.Tuple([*value.elts[:i], other, *value.elts[i + 1 :]], ast.Load())


def others(node, function):
    """Give what may stand for a node: other fields of it, or another node."""
    match node:
        case ast.BinOp() | ast.AugAssign() | ast.BoolOp():
            yield from ({"op": operator()} for operator in OPERATORS.get(type(node.op), []))
        case ast.Compare():
            for i, old in enumerate(node.ops):
                for operator in OPERATORS.get(type(old), []):
                    yield {"ops": [*node.ops[:i], operator(), *node.ops[i + 1 :]]}
        case ast.UnaryOp():
            yield node.operand
        case ast.Constant(bool(value)):
            yield {"value": not value}
        case ast.Constant(int(value) | float(value)):
            yield from ({"value": value + by} for by in (1, -1))
        case ast.Break() | ast.Continue():
            yield ast.Continue() if isinstance(node, ast.Break) else ast.Break()
        case ast.Return() if node.value and function:
            yield from ({"value": v} for v in other_results(node.value, function.returns))
        case ast.Subscript(slice=ast.Name()):
            yield {"slice": one_more(node.slice)}
        case ast.Subscript(slice=ast.Tuple(at)):
            for i, index in enumerate(at):
                if isinstance(index, ast.Name):
                    places = [*at[:i], one_more(index), *at[i + 1 :]]
                    yield {"slice": ast.Tuple(places, ast.Load())}


def mutants(text):
    """Give each mutant of a module: function or None, line:column, old and new text, the tree.

    The tree is one and the same, changed until the next one is asked for.
    """
    tree = ast.parse(text)

    def within(node, function):
        for name, field in list(ast.iter_fields(node)):
            several = isinstance(field, list)
            for i, child in enumerate(field if several else [field]):
                if name in NOT_RUN or not isinstance(child, ast.AST):
                    continue
                inside = function or (child if isinstance(child, ast.FunctionDef) else None)
                for new in others(child, inside):
                    if isinstance(new, dict):
                        new = type(child)(**dict(ast.iter_fields(child)) | new)
                    ast.copy_location(new, child)
                    setattr(node, name, [*field[:i], new, *field[i + 1 :]] if several else new)
                    place = f"{child.lineno}:{child.col_offset + 1}"
                    yield inside and inside.name, place, ast.unparse(child), ast.unparse(new)
                    setattr(node, name, field)
                yield from within(child, inside)

    for mutant in within(tree, None):
        yield *mutant, ast.fix_missing_locations(tree)


class Loader(importlib.abc.InspectLoader):
    """Runs code that is no file's."""

    def __init__(self, code):
        self.code = code

    def get_code(self, name):
        return self.code

    def get_source(self, name):
        raise ImportError(name)


def replace(module, tree):
    """Put a changed module's functions and constants in the place of those that are there.

    What other modules have computed of a constant stays as it was.
    """
    loader = Loader(compile(tree, module.__file__, "exec"))
    spec = importlib.util.spec_from_loader(module.__name__, loader, origin=module.__file__)
    changed = importlib.util.module_from_spec(spec)
    loader.exec_module(changed)
    for name, new in vars(changed).items():
        old = vars(module).get(name)
        if new is old or name.startswith("__"):
            continue
        if hasattr(old, "cache_clear"):
            old.cache_clear()
            old, new = old.__wrapped__, new.__wrapped__
        if isinstance(new, types.FunctionType):
            old.__code__, old.__defaults__ = new.__code__, new.__defaults__
        elif isinstance(new, int | float | tuple | np.generic | np.ndarray):
            for other in list(sys.modules.values()):
                if vars(other).get(name) is old:
                    setattr(other, name, new)


def forked(work, seconds):
    """Call a function in a fork; give what it gives, None if it failed or ran out of time."""
    reading, writing = os.pipe()
    process = os.fork()
    if not process:
        try:
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            result = json.dumps(work()).encode()
            with os.fdopen(writing, "wb") as pipe:
                pipe.write(result)
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        result = pipe.read()
    os.waitpid(process, 0)
    return json.loads(result) if result else None


def fewer_examples(item):
    """Let hypothesis draw less for a test; give whether it is one of hypothesis."""
    test, name = item.obj, "_hypothesis_internal_use_settings"
    if hasattr(test, name):
        setattr(test, name, settings(getattr(test, name), max_examples=FEW))
    return hasattr(test, name)


class Trial:
    """What a pytest does with its tests instead of running them once."""

    def __init__(self, given):
        self.given, self.failed = given, False

    def pytest_runtest_logreport(self, report):
        self.failed |= report.failed

    def passes(self, items):
        for item in items:
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
            if self.failed:
                break
        return not self.failed

    def traced(self, item):
        """Run a test; give whether it passes, its seconds, and the kernels that it calls."""
        called, begin = set(), time.process_time()
        sys.settrace(lambda frame, event, _: called.add(frame.f_code))
        passed = self.passes([item])
        sys.settrace(None)
        kernels = {(code.co_filename, code.co_name) for code in called}
        took = time.process_time() - begin
        return passed, took, [k for k in kernels if k[0].startswith(str(KERNELS))]

    def pytest_runtestloop(self, session):
        self.known = []  # of each test: kernels, seconds, item
        for item in session.items:
            found = forked(lambda item=item: self.traced(item), SLOW)
            if not found and fewer_examples(item):
                found = forked(lambda item=item: self.traced(item), SLOW)
            if not found:
                print(f"slow, left out: {item.nodeid}")
            elif not found[0]:
                raise pytest.UsageError(f"{item.nodeid} fails without the compiler")
            else:
                self.known.append(({tuple(kernel) for kernel in found[2]}, found[1], item))
        self.known.sort(key=lambda test: (len(test[0]), test[1]))
        turns = collections.Counter()

        def turn(test):
            turns[test[2].function] += 1
            return turns[test[2].function]

        self.known.sort(key=turn)
        self.try_all()
        return True

    def tests(self, file, function):
        """Give the tests of a function; of what is in none, those of its module, else of all."""
        calls = [lambda kernels: (file, function) in kernels]
        if function is None:
            calls = [lambda kernels: any(file == at for at, _ in kernels), len]
        for of in calls:
            found, total = [], 0.0
            for kernels, took, item in self.known:
                if of(kernels) and (not found or total + took <= BUDGET):
                    found, total = [*found, item], total + took
            if found:
                return found, total
        return [], 0.0

    def survives(self, module, function, tree):
        found, took = self.tests(module.__file__, function)

        def trial():
            replace(module, tree)
            return self.passes(found)

        return forked(trial, int(2 + 2 * took))

    def try_all(self):
        texts = {}
        for file in sorted(KERNELS.rglob("[!_]*.py")):
            name = file.relative_to(KERNELS).with_suffix("").as_posix()
            if name not in LEFT_OUT and self.given.only in name:
                texts[name] = file.read_text("utf-8")
        counts = {name: sum(1 for _ in mutants(text)) for name, text in texts.items()}
        every, tried, survived = sum(counts.values()), 0, 0
        for name, text in texts.items():
            module = importlib.import_module(f"gapath.kernels.{name.replace('/', '.')}")
            if not self.survives(module, None, ast.parse(text)):
                raise pytest.UsageError(f"{name}: a test fails though nothing is changed")
            share = round(counts[name] * self.given.tried / every)
            drawn = random.Random(f"{self.given.seed} {name}").sample(
                range(counts[name]), min(counts[name], max(LEAST, share))
            )
            lines = [
                f"  {name}.py:{place}  {old} -> {new}"
                for i, (function, place, old, new, tree) in enumerate(mutants(text))
                if i in drawn and self.survives(module, function, tree)
            ]
            killed = len(drawn) - len(lines)
            tried, survived = tried + len(drawn), survived + len(lines)
            print(f"{name}: {len(drawn)} tried, {killed} killed", *lines, sep="\n", flush=True)
        print(f"{tried} of {every} tried, {tried - survived} killed: {1 - survived / tried:.1%}")


def main():
    words = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    words.add_argument("--tried", type=int, default=1500, help="mutants, drawn from all modules")
    words.add_argument("--seed", type=int, default=1, help="draws them")
    words.add_argument("--only", default="", help="modules whose name holds this, memetic/walls")
    words.add_argument("--tests", nargs="+", default=["tests/kernels", *PLANNERS])
    given = words.parse_args()
    os.chdir(ROOT)
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    settings.register_profile(
        "mutants",
        deadline=None,
        derandomize=True,
        database=None,
        phases=[Phase.explicit, Phase.generate],  # one failure will do, however large
        suppress_health_check=list(HealthCheck),
    )
    without = ["-pno:terminal", "-pno:cacheprovider", "-pno:xdist"]
    plain = ["-o", "addopts=", "-s", "-W", "ignore", "--hypothesis-profile=mutants", *without]
    return pytest.main([*plain, *given.tests], [Trial(given)])


if __name__ == "__main__":
    sys.exit(main())
