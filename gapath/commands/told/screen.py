"""The words that do no run: ``gapath --help``, ``help``, ``maps``, ``planners``, ``navigators``.

Nothing here imports Hydra or numba, but for the picture of a map, which has to be read.
"""

import sys
from collections.abc import Callable, Sequence

from gapath.errors import InputError, printable

SCREEN = """\
gapath plans paths for mobile robots with genetic algorithms, records every
step, and writes one folder per run.

usage: gapath [-m] [GROUP=NAME ...] [SETTING=VALUE ...]

  gapath map=kg18_test3 planner=ga3 seed=7             plan once
  gapath -m map=kg18_test1,kg18_test2 planner=ga1,ga2,astar trials=1000
                                                       all of these: a sweep
  gapath task=drive map=kg18_map4 navigator=kg18       through an unknown map
  gapath map=file map.path=office.yaml 'map.start=[10,20]' 'map.target=[80,40]'
  gapath experiment=table1                             a published experiment

what there is
  gapath maps | planners | navigators                  names, one line each
  gapath maps kg18_test4                               a map, and its picture
  gapath help planner.population                       what a setting means
  gapath help ga3                                      a name, with all settings
  gapath help                                          groups, and root settings

what came of it
  gapath log view KEY          a run's log: gapath log --help
  gapath report outputs/       tables, figures, questions: gapath report --help
  gapath genotype MAP          whether S04's genotypes can express a path there

options: -m a sweep; --cfg job shows settings and runs nothing; --version
tab completion: eval "$(gapath -sc install=bash)"
"""


def tell(words: Sequence[str]) -> int:
    """Do what the first word says.

    Parameters
    ----------
    words : sequence of str
        A key of `WORDS`, and what is asked.

    Returns
    -------
    int
        Exit code: 0, or 2 for a word that is not known.
    """
    try:
        print(WORDS[words[0]](words[1:]), flush=True)
    except BrokenPipeError:  # gapath maps | head
        sys.stderr.close()
    except InputError as error:
        print(f"gapath: {printable(error)}", file=sys.stderr)
        return 2
    return 0


def _help(words: Sequence[str]) -> str:
    from gapath.commands.told.topics import overview, topic

    return "\n\n".join(map(topic, words)) if words else overview()


def _listed(group: str) -> Callable[[Sequence[str]], str]:
    def told(names: Sequence[str]) -> str:
        from gapath.commands.told.topics import chosen, listed

        return "\n\n".join(chosen(group, name) for name in names) if names else listed(group)

    return told


def _maps(names: Sequence[str]) -> str:
    if not names:
        return _listed("map")(names)
    from gapath.commands.told.picture import pictured

    return "\n\n".join(map(pictured, names))


def _screen(words: Sequence[str]) -> str:
    return SCREEN.rstrip()


WORDS: dict[str, Callable[[Sequence[str]], str]] = {
    "--help": _screen,
    "help": _help,
    "maps": _maps,
    "planners": _listed("planner"),
    "navigators": _listed("navigator"),
}
"""The first word of a command line -> what it tells."""
