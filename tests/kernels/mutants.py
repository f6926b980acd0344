"""Change kernels one place at a time, and tell which changes no test notices: `make mutants`.

Without the compiler kernels are functions of Python. One pytest has collected all tests; for each
mutant it is forked, the changed code is put into the functions where they are, so that whoever
imported them has it, and the tests that call the function are run until one fails. No file is
written. Mutants that run out of their time count as killed. Left out is what only the compiler
understands: `LEFT_OUT`.
"""

import argparse
import ast
import importlib.abc
import importlib.util
import json
import os
import random
import resource
import sys
import time
import types
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
KERNELS = ROOT / "gapath" / "kernels"
TESTS = "tests/kernels"

LEFT_OUT = {"jit", "kg18/evaluation", "kg18/field_lanes", "kg18/lanes", "kg18/vectors"}
"""The decorator, and vectors."""

SLOW = 5
"""Seconds: a test that takes longer without the compiler is left out."""
BUDGET = 8
"""Seconds of tests for a mutant: those that call the fewest kernels go first."""
MEMORY = 8 << 30
LEAST = 10
"""Mutants of each module, if it has as many."""

OPERATORS = {
    ast.Add: [ast.Sub],
    ast.Sub: [ast.Add],
    ast.Mult: [ast.FloorDiv],
    ast.FloorDiv: [ast.Mult],
    ast.Div: [ast.Mult],
    ast.Mod: [ast.FloorDiv],
    ast.LShift: [ast.RShift],
    ast.RShift: [ast.LShift],
    ast.BitAnd: [ast.BitOr],
    ast.BitOr: [ast.BitAnd],
    ast.BitXor: [ast.BitOr],
    ast.And: [ast.Or],
    ast.Or: [ast.And],
    ast.Lt: [ast.LtE, ast.GtE],
    ast.LtE: [ast.Lt, ast.Gt],
    ast.Gt: [ast.GtE, ast.LtE],
    ast.GtE: [ast.Gt, ast.Lt],
    ast.Eq: [ast.NotEq],
    ast.NotEq: [ast.Eq],
    ast.Is: [ast.IsNot],
    ast.IsNot: [ast.Is],
}
NOT_RUN = {"annotation", "returns", "decorator_list"}


def one_more(node, by=1):
    return ast.BinOp(node, ast.Add(), ast.Constant(by))


def other_result(value, annotation):
    """Results that are not what a function gives, by the type that it says."""
    match annotation:
        case ast.Name("int" | "float"):
            yield one_more(value)
        case ast.Name("bool"):
            yield ast.UnaryOp(ast.Not(), value)
        case ast.Subscript(ast.Name("tuple"), ast.Tuple(kinds)) if isinstance(value, ast.Tuple):
            for i, kind in enumerate(kinds[: len(value.elts)]):
                for other in other_result(value.elts[i], kind):
                    yield ast.Tuple([*value.elts[:i], other, *value.elts[i + 1 :]], ast.Load())


def others(node, function):
    """Give what may stand for a node, as fields of it with other values, or as another node."""
    match node:
        case ast.BinOp() | ast.AugAssign() | ast.BoolOp():
            for operator in OPERATORS.get(type(node.op), []):
                yield {"op": operator()}
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
        case ast.Break():
            yield ast.Continue()
        case ast.Continue():
            yield ast.Break()
        case ast.Return() if node.value and function:
            yield from ({"value": v} for v in other_result(node.value, function.returns))
        case ast.Subscript(slice=ast.Name()):
            yield {"slice": one_more(node.slice)}
        case ast.Subscript(slice=ast.Tuple(at)):
            for i, index in enumerate(at):
                if isinstance(index, ast.Name):
                    places = [*at[:i], one_more(index), *at[i + 1 :]]
                    yield {"slice": ast.Tuple(places, ast.Load())}


def mutants(text):
    """Give each mutant of a module: function or None, line, old and new text, the whole tree.

    The tree is one and the same, changed until the next one is asked for.
    """
    tree = ast.parse(text)

    def within(node, function):
        for name, field in ast.iter_fields(node):
            if name in NOT_RUN:
                continue
            for i, child in enumerate(field if isinstance(field, list) else [field]):
                if not isinstance(child, ast.AST) or isinstance(child, ast.ClassDef):
                    continue
                inside = function or (child if isinstance(child, ast.FunctionDef) else None)
                for other in others(child, inside):
                    new = other
                    if isinstance(other, dict):
                        new = type(child)(**dict(ast.iter_fields(child)) | other)
                    ast.copy_location(new, child)
                    put(node, name, i, new)
                    yield inside and inside.name, child.lineno, ast.unparse(child), ast.unparse(new)
                    put(node, name, i, child)
                yield from within(child, inside)

    for mutant in within(tree, None):
        yield *mutant, ast.fix_missing_locations(tree)


def put(node, name, i, child):
    if isinstance(getattr(node, name), list):
        getattr(node, name)[i] = child
    else:
        setattr(node, name, child)


class Loader(importlib.abc.InspectLoader):
    """Runs code that is no file's."""

    def __init__(self, code):
        self.code = code

    def get_code(self, name):
        return self.code

    def get_source(self, name):
        raise ImportError(name)


def replace(module, tree):
    """Put the functions and constants of a changed module where those that are there have gone.

    What other modules have computed of a constant stays as it was.
    """
    loader = Loader(compile(tree, module.__file__, "exec"))
    changed = importlib.util.module_from_spec(
        importlib.util.spec_from_loader(module.__name__, loader, origin=module.__file__)
    )
    loader.exec_module(changed)
    for name, new in vars(changed).items():
        old = vars(module).get(name)
        if new is old or name.startswith("__"):
            continue
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
            os.close(reading)
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
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


class Trial:
    """A pytest that tries mutants instead of running its tests once."""

    def __init__(self, given):
        self.given, self.failed = given, False

    def pytest_runtest_logreport(self, report):
        self.failed |= report.failed

    def passes(self, items):
        for item, after in zip(items, [*items[1:], None], strict=True):
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            if self.failed:
                return False
        return True

    def traced(self, item):
        """Run a test; give whether it passes, its seconds, and the kernels that it calls."""
        called = set()
        begin = time.process_time()
        sys.settrace(lambda frame, event, _: called.add(frame.f_code))
        passed = self.passes([item])
        sys.settrace(None)
        took = time.process_time() - begin
        kernels = {(code.co_filename, code.co_name) for code in called}
        return passed, took, [k for k in kernels if k[0].startswith(str(KERNELS))]

    def pytest_runtestloop(self, session):
        known, left = [], []  # tests: kernels, seconds, item
        for item in session.items:
            passed, took, kernels = forked(lambda item=item: self.traced(item), SLOW) or (0, 0, 0)
            if passed:
                known.append(({tuple(k) for k in kernels}, took, item))
            else:
                left.append((item.nodeid, passed is False))
        for name, failed in left:
            print(f"{'fails' if failed else 'slow, left out'}: {name}")
        if any(failed for _, failed in left):
            raise pytest.UsageError("a test fails without the compiler and with no mutant")
        self.known = sorted((k for k in known if k[0]), key=lambda test: (len(test[0]), test[1]))
        self.report()
        return True

    def tests(self, file, function):
        """Tests of a function, or of all that is in a module, or of all kernels."""
        for of in (
            lambda kernels: (file, function) in kernels,
            lambda kernels: function is None and any(file == at for at, _ in kernels),
            lambda kernels: function is None,
        ):
            found, total = [], 0.0
            for kernels, took, item in self.known:
                if of(kernels) and (not found or total + took <= BUDGET):
                    found.append(item)
                    total += took
            if found:
                return found, total
        return [], 0.0

    def survives(self, module, function, tree):
        found, took = self.tests(module.__file__, function)

        def trial():
            replace(module, tree)
            return self.passes(found)

        return not found or forked(trial, int(3 + 4 * took))

    def report(self):
        modules = {
            file.relative_to(KERNELS).with_suffix("").as_posix(): file
            for file in sorted(KERNELS.rglob("*.py"))
        }
        texts = {
            name: file.read_text("utf-8")
            for name, file in modules.items()
            if name not in LEFT_OUT and not name.endswith("__init__") and self.given.only in name
        }
        counts = {name: sum(1 for _ in mutants(text)) for name, text in texts.items()}
        share = min(1.0, self.given.tried / sum(counts.values()))
        print(f"{sum(counts.values())} mutants of {len(counts)} modules", flush=True)
        totals = Counter()
        for name, text in texts.items():
            module = importlib.import_module(f"gapath.kernels.{name.replace('/', '.')}")
            if not self.survives(module, None, ast.parse(text)):
                raise pytest.UsageError(f"{name}: a test fails though nothing is changed")
            tried = min(counts[name], max(LEAST, round(share * counts[name])))
            drawn = random.Random(f"{self.given.seed} {name}").sample(range(counts[name]), tried)
            lines = []
            for i, (function, line, old, new, tree) in enumerate(mutants(text)):
                if i in drawn and self.survives(module, function, tree):
                    none = "" if self.tests(module.__file__, function)[0] else "  (no test)"
                    lines.append(
                        f"  {modules[name].relative_to(ROOT)}:{line}  {old} -> {new}{none}"
                    )
            totals.update(tried=tried, survived=len(lines))
            print(
                f"{name}: {tried} tried, {tried - len(lines)} killed", *lines, sep="\n", flush=True
            )
        killed = totals["tried"] - totals["survived"]
        print(f"all: {totals['tried']} tried, {killed} killed, {killed / totals['tried']:.1%}")


def main():
    words = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    words.add_argument("--tried", type=int, default=1500, help="mutants, drawn from all modules")
    words.add_argument("--seed", type=int, default=1, help="draws them")
    words.add_argument("--only", default="", help="modules whose name holds this, memetic/walls")
    words.add_argument("--tests", default=TESTS, help="a folder or file of tests")
    given = words.parse_args()
    os.chdir(ROOT)
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    sys.dont_write_bytecode = True
    from hypothesis import HealthCheck, Phase, settings

    settings.register_profile(
        "mutants",
        deadline=None,
        derandomize=True,
        database=None,
        max_examples=100,
        phases=[Phase.explicit, Phase.generate],  # one failure will do, however large
        suppress_health_check=list(HealthCheck),
    )
    plain = ["-o", "addopts=", "-p", "no:terminal", "-p", "no:cacheprovider", "-p", "no:xdist"]
    own = ["-s", "--hypothesis-profile=mutants", "-W", "ignore"]
    return pytest.main([*plain, *own, given.tests], plugins=[Trial(given)])


if __name__ == "__main__":
    sys.exit(main())
