"""Why a command line cannot be used, in one line: what Hydra says, said of a setting."""

import argparse
import contextlib
import re
import shlex
import traceback
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

import yaml
from hydra import compose, initialize_config_dir
from hydra._internal.core_plugins.file_config_source import FileConfigSource
from hydra._internal.utils import get_args_parser
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from hydra.plugins.config_source import ConfigResult
from omegaconf import DictConfig
from omegaconf.errors import OmegaConfBaseException

from gapath.discovery import OFFERS, kinds, with_setting, yaml_names, yaml_values
from gapath.errors import InputError, Missing, did_you_mean, few, one_of, packages_of, require
from gapath.running.config import conf_folder
from gapath.store.settings import LONGEST_WHOLE, plain_yaml
from gapath.task import find_task

BAD_CONFIGURATION = (InputError, HydraException, OmegaConfBaseException)
"""What is raised where a command line or a configuration is wrong."""

_LONG = re.compile(rf"\d{{{LONGEST_WHOLE + 1},}}")


def arguments() -> argparse.Namespace:
    """Read the command line as Hydra will; raises InputError for an unknown option."""

    def refuse(message: str) -> NoReturn:
        raise InputError("command line", message, "key=value, options before or after all of them")

    parser: Any = get_args_parser()
    parser.error = refuse
    given: argparse.Namespace = parser.parse_args()
    return given


class Bounded(FileConfigSource):  # type: ignore[misc]
    """Hydra's reader of YAMLs; of a user's or a stranger's first looks whether it is one."""

    def load_config(self, config_path: str) -> ConfigResult:
        """Read a YAML; raises InputError if `plain_yaml` does, or it is no regular file."""
        if not Path(self.path).is_relative_to(conf_folder()):
            file = Path(self.path, self._normalize_file_name(config_path))
            plain_yaml(file, str(file), "a YAML of settings")
        return super().load_config(config_path)


Bounded.__name__ = FileConfigSource.__name__  # workers register Hydra's again: by name it is one


def check_used(words: Sequence[str], task: str) -> None:
    """Raise InputError if something was set on the command line that the task does not use."""
    find_task(task)
    users: dict[str, list[str]] = {}
    for name in kinds("task"):
        for group in find_task(name).groups:
            users.setdefault(group, []).append(name)
    for word in words:
        key, _, value = word.lstrip("+~").partition("=")
        group = key.partition(".")[0]
        able = users.get(group, [task])
        good = " or ".join(f"task={name}" for name in able)
        expected = f"{good}, to which the group {group} belongs"
        require(task in able, key, f"{value or repr('')} with task={task}", expected)


def check_once(words: Sequence[str]) -> None:
    """Raise InputError if something is set twice: Hydra would take the last."""
    given: dict[str, str] = {}
    for word in words:
        key, _, value = word.lstrip("+~").partition("=")
        require(key not in given, key, f"{given.get(key)} and {value}", "one value")
        given[key] = value


def check_own(words: Sequence[str], runtime: DictConfig) -> None:
    """Raise InputError if a YAML was chosen by anything but its name.

    Or by a name that gapath has first, if it is the user's own.
    """
    chosen = [(group, str(name)) for group, name in runtime.choices.items() if name is not None]
    for key, _, value in (word.lstrip("+").partition("=") for word in words):
        several = _LIST.fullmatch(value)  # which to Hydra are no choice
        if key in OFFERS and several:
            chosen += [(key, name.strip()) for name in several[1].split(",")]
    for group, name in chosen:
        good = not name or _CHOICE.fullmatch(name) is not None
        require(good, group, name, "the name of a YAML, without a folder and an ending")
    for source in runtime.config_sources:
        for group, name in runtime.choices.items():
            if source["provider"] == "command-line" and name in yaml_names(group):
                file = Path(source["path"], group, f"{name}.yaml")
                require(not file.exists(), group, file, f"another name: gapath has its own {name}")


_LIST = re.compile(r"\[(.*)\]")
_CHOICE = re.compile(r"(?:[^./\\]+/)*[^./\\]+")


def explain(error: BaseException, words: Sequence[str], sweep: bool) -> str | None:
    """Say what is wrong with a command line.

    Parameters
    ----------
    error : BaseException
        What was raised.
    words : sequence of str
        What was set on the command line, ``key=value`` each.
    sweep : bool
        Whether it was called for one.

    Returns
    -------
    str or None
        One line: the setting, what was found there, and what would be right. None if nothing is
        found to be wrong, and the error is none of `BAD_CONFIGURATION`.
    """
    if not isinstance(error, InputError):
        with contextlib.suppress(Exception):  # it stumbles over the same again
            error = _found(error, words, sweep) or error
    if isinstance(error, yaml.YAMLError | UnicodeDecodeError) or _hydras_own(error):
        error = InputError("configuration", error, "YAML that can be read, as UTF-8")
    if isinstance(error, InputError):
        return " ".join(str(error).split())
    if not isinstance(error, BAD_CONFIGURATION):
        return None
    said = (getattr(error, "full_key", ""), error, error.__cause__)
    lines = [str(each).strip().partition("\n")[0] for each in said if each]
    return ": ".join(lines) or type(error).__name__


def _hydras_own(error: BaseException) -> bool:
    """Tell whether Hydra stumbled itself, over a YAML of a shape that it does not expect."""
    places = traceback.extract_tb(error.__traceback__)
    known = isinstance(error, BAD_CONFIGURATION)
    return not known and bool(places) and "hydra" in Path(places[-1].filename).parts


def _found(error: BaseException, words: Sequence[str], sweep: bool) -> InputError | None:
    """Find the setting that an error of Hydra's is about, and what would be right."""
    if isinstance(error, MissingConfigException) and "/" in (error.missing_cfg_file or ""):
        group, _, name = error.missing_cfg_file.rpartition("/")
        if missing := missing_engine(group, name):
            return missing
        with _hydra():
            names = GlobalHydra.instance().config_loader().get_group_options(group)
        right = one_of(name, names)
        if group in OFFERS and name in kinds(group):
            of_it = [y for y in yaml_names(group) if yaml_values(group, y)["kind"] == name]
            there = f"is that of {few(of_it)}" if of_it else f"has no conf/{group}/{name}.yaml yet"
            right += f"; the kind {name} {there}"
        return InputError(group, name, right)
    with _hydra():
        if isinstance(error, OverrideParseException):
            return _unreadable(error.override)
        for word in words:  # Python refuses to read it, and does not say where it stands
            key, _, value = word.partition("=")
            if size := max(map(len, _LONG.findall(value)), default=0):
                return InputError(key, f"a number of {size} digits", f"at most {LONGEST_WHOLE}")
        parsed = OverridesParser.create().parse_overrides(list(words))
        groups = set(GlobalHydra.instance().config_loader().list_groups(""))
        chosen = [
            each
            for each in parsed
            if each.key_or_group in groups | _HYDRAS and not isinstance(each.value(), dict)
        ]
        plain = compose("config", return_hydra_config=True)
        faults = [_fault_of_choice(each, plain, sweep) for each in chosen]
        if not any(faults):
            names = [each.input_line for each in chosen if not each.is_sweep_override()]
            with contextlib.suppress(*BAD_CONFIGURATION):
                config = compose("config", overrides=names, return_hydra_config=True)
                others = [each for each in parsed if each not in chosen]
                faults = [_fault_of_value(each, config, groups, sweep) for each in others]
        return next(filter(None, faults), None)


_HYDRAS = {"hydra/launcher", "hydra/sweeper", "hydra/sweeper/sampler"}
"""Groups of Hydra's that are chosen from."""

_EXTRAS = {
    "hydra/launcher/joblib": "joblib",
    "hydra/launcher/submitit": "cluster",
    "hydra/launcher/ray": "ray",
    "hydra/sweeper/optuna": "tune",
}
"""What the choice of an engine or a sweeper begins with -> the extra of gapath that has it."""


def missing_engine(group: str, name: str) -> Missing | None:
    """Say which extra an engine or a sweeper comes with that is not there; None if with none."""
    extras = (extra for begin, extra in _EXTRAS.items() if f"{group}/{name}".startswith(begin))
    extra = next(extras, None)
    return Missing(f"{group}={name}", extra, packages_of(extra)) if extra else None


@contextlib.contextmanager
def _hydra() -> Iterator[None]:
    """Use Hydra as it is, or start it again after it has ended."""
    if GlobalHydra.instance().is_initialized():
        yield
    else:
        with initialize_config_dir(conf_folder(), version_base="1.3"):
            yield


def _unreadable(word: str) -> InputError:
    key, equals, value = word.partition("=")
    if equals and value[:1] in ("[", "{", "(", '"', "'"):
        return InputError(key, value, "a whole list [x, y], mapping {name: value} or quoted text")
    if equals:
        quoted = shlex.quote(f'{key}="{value}"')
        return InputError(key, value, f"quotes around what is no plain word, {quoted}")
    loader = GlobalHydra.instance().config_loader()
    every = {name: f"{group}={name}"
             for group in loader.list_groups("") for name in loader.get_group_options(group)
             if group != "hydra"}  # fmt: skip
    return InputError(word, "a word alone", f"key=value{did_you_mean(word, every)}")


def _fault_of_choice(override: Override, plain: DictConfig, sweep: bool) -> InputError | None:
    """Tell what is wrong with the choice of a YAML."""
    key, word = override.key_or_group, override.input_line
    value = word.partition("=")[2]
    if override.is_sweep_override():
        return _fault_of_sweep(override, sweep)
    names = GlobalHydra.instance().config_loader().get_group_options(key)
    single = key in plain.hydra.runtime.choices
    added = not single and key not in plain
    chosen = override.value()
    chosen = chosen if isinstance(chosen, list) and not single else [chosen]
    if not override.is_delete() and not all(isinstance(name, str) for name in chosen):
        return InputError(key, value, one_of(value, names) + ("" if single else ", or a list"))
    if added and not override.is_add():
        return InputError(key, value, f"+{word}")
    if single and override.is_add():
        return InputError(key, word, word.removeprefix("+"))
    return None


def _fault_of_value(
    override: Override, config: DictConfig, groups: set[str], sweep: bool
) -> InputError | None:
    """Tell what is wrong with setting a value in what the chosen YAMLs give."""
    key, word = override.key_or_group, override.input_line
    if not key:
        return InputError(repr(word), "no name", "key=value")
    if fault := _fault_of_sweep(override, sweep):
        return fault
    place: Any = config
    done: list[str] = []
    for step in key.split("."):
        if not isinstance(place, DictConfig):
            return InputError(key, "an unknown name", f"{'.'.join(done)}, which is one value")
        names = [str(name) for name in place]
        if not done and step != "hydra":
            names = sorted({*names, *groups} - {"hydra"})
        if step not in names:
            if override.is_add():
                return None  # whoever uses it knows whether there may be one
            where = ".".join([*done, step])
            group = done[0] if len(done) == 1 else ""
            if group in OFFERS and (others := with_setting(group, step)):
                right = f"{others}, which has it"
                if sweep:  # Hydra holds it against the group's default before it looks at jobs
                    right += f"; in a sweep over several of these, ++{word}"
                return InputError(where, f"an unknown name with this {group}", right)
            return InputError(where, "an unknown name", one_of(step, names))
        done.append(step)
        place = place._get_node(step)
    if isinstance(override.value(), dict) and isinstance(place, DictConfig):
        names = [str(name) for name in place]
        for name in override.value():
            if name not in names and not override.is_add():
                return InputError(f"{key}.{name}", "an unknown name", one_of(name, names))
    if override.is_add() and not override.is_force_add():
        return InputError(key, word, word.removeprefix("+"))
    return None


def _fault_of_sweep(override: Override, sweep: bool) -> InputError | None:
    if not override.is_sweep_override() or sweep:
        return None
    value = override.input_line.partition("=")[2]
    expected = "one value; gapath -m runs a sweep over several"
    return InputError(override.key_or_group, value, expected)
