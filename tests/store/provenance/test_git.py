"""What git says of a folder: of any repository, whatever it would like to do."""

import os
import shutil
import subprocess
import time

import pytest

from gapath.store.provenance import git
from gapath.store.provenance.git import Tree, is_tracked, top_of, tree_of

pytestmark = pytest.mark.skipif(not shutil.which("git"), reason="git is not installed")


def run(place, *words, **environment):
    own = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1", **environment}
    names = ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "protocol.allow=always"]
    done = subprocess.run(
        ["git", *names, *words], cwd=place, env=os.environ | own, capture_output=True, timeout=60
    )
    return done.stdout.decode()


def look(place):
    """Look anew, not at what is recalled."""
    git._looked.clear()
    top = top_of(place)
    return tree_of(top) if top else None


@pytest.fixture
def repository(tmp_path):
    place = tmp_path / "repository"
    (place / "within").mkdir(parents=True)
    (place / "a.py").write_text("a = 1\n")
    (place / "within" / "b.py").write_text("b = 1\n")
    (place / ".gitignore").write_text("ignored*\n")
    run(place, "init", "-q")
    run(place, "add", ".")
    run(place, "commit", "-q", "-m", "first")
    return place


def test_a_clean_tree_is_its_commit(repository):
    (repository / "ignored.py").write_text("")
    head = run(repository, "rev-parse", "HEAD").strip()
    said = {"commit": head, "clean": True, "untracked": 0, "untracked_names": ""}
    assert look(repository) == look(repository / "within") == Tree(said)


EDITS = {
    "edited": lambda place: (place / "a.py").write_text("a = 2\n"),
    "staged": lambda place: ((place / "a.py").write_text("a = 2\n"), run(place, "add", ".")),
    "gone": lambda place: (place / "within" / "b.py").unlink(),
    "renamed": lambda place: run(place, "mv", "a.py", "c.py"),
    "binary": lambda place: (place / "a.py").write_bytes(bytes(range(256))),
    "may be run": lambda place: (place / "a.py").chmod(0o755),
    "odd name": lambda place: (
        (place / "odd\n\x1b[31m name").write_text("1"),
        run(place, "add", "."),
    ),
    "configured": lambda place: (
        (place / "a.py").write_text("a = 2\n"),
        run(place, "config", "diff.noprefix", "true"),
        run(place, "config", "diff.renames", "copies"),
        run(place, "config", "color.ui", "always"),
        run(place, "config", "status.showUntrackedFiles", "no"),
    ),
}


@pytest.mark.parametrize("name", EDITS)
def test_the_commit_and_the_diff_make_the_tree_again(repository, tmp_path, name):
    EDITS[name](repository)
    tree = look(repository)
    assert not tree.said["clean"] and tree.diff and "told" not in tree.said
    run(tmp_path, "clone", "-q", str(repository), "copy")
    run(tmp_path / "copy", "checkout", "-q", str(tree.said["commit"]))
    (tmp_path / "code.diff").write_bytes(tree.diff)
    run(tmp_path / "copy", "apply", str(tmp_path / "code.diff"))

    def files(place):
        found = (path for path in place.rglob("*") if ".git" not in path.parts and path.is_file())
        return {p.relative_to(place): (p.read_bytes(), p.stat().st_mode & 0o100) for p in found}

    assert files(tmp_path / "copy") == files(repository)


def test_untracked_files_are_counted_and_some_named(repository):
    for i in range(50):
        (repository / f"{i:02}\n\x1b[31m").write_text("")
    (repository / os.fsdecode(b"\xff")).write_text("")
    (repository / ("l" * 200)).write_text("")
    said = look(repository).said
    assert said["clean"] and said["untracked"] == 52
    assert said["untracked_names"].startswith("00\n\x1b[31m, 01\n")
    assert len(said["untracked_names"]) < 2100


def test_a_linked_work_tree_has_its_own_state(repository, tmp_path):
    run(repository, "worktree", "add", "-q", "-b", "other", str(tmp_path / "linked"))
    (tmp_path / "linked" / "a.py").write_text("a = 3\n")
    assert look(repository).said["clean"]
    assert b"+a = 3" in look(tmp_path / "linked").diff


def test_what_a_repository_ignores_is_no_part_of_it(repository):
    (repository / "ignored").mkdir()
    (repository / "ignored" / "c.py").write_text("")
    assert not is_tracked(repository, repository / "ignored" / "c.py")
    assert is_tracked(repository, repository / "within" / "b.py")


def test_a_hook_of_another_repository_does_not_mislead(repository, tmp_path, monkeypatch):
    (tmp_path / "other").mkdir()
    run(tmp_path / "other", "init", "-q")
    expected = look(repository)
    monkeypatch.setenv("GIT_DIR", str(tmp_path / "other" / ".git"))
    monkeypatch.setenv("GIT_INDEX_FILE", str(tmp_path / "none"))
    assert look(repository) == expected


def pipe(path):
    path.unlink()
    os.mkfifo(path)


NONE = {
    "a folder that is none": (lambda place: shutil.rmtree(place / ".git"), None),
    "no commit": (lambda place: (shutil.rmtree(place / ".git"), run(place, "init", "-q")), ""),
    "an empty file": (
        lambda place: (shutil.rmtree(place / ".git"), (place / ".git").write_text("")),
        "git config fails with exit code 128",
    ),
    "a ring of links": (
        lambda place: (shutil.rmtree(place / ".git"), (place / ".git").symlink_to(".git")),
        "git status fails with exit code 128",
    ),
    "an index of nothing": (
        lambda place: (place / ".git" / "index").write_bytes(b"nothing"),
        "git status fails with exit code 128",
    ),
    "objects that are gone": (
        lambda place: ((place / "a.py").write_text("2"), shutil.rmtree(place / ".git" / "objects")),
        "git status fails with exit code 128",
    ),
    "a configuration of nothing": (
        lambda place: (place / ".git" / "config").write_bytes(b"[\0"),
        "git config fails with exit code 128",
    ),
    "a pipe": (lambda place: pipe(place / ".git" / "config"), "git takes longer than 0.5 s"),
}


@pytest.mark.parametrize("name", NONE)
def test_what_cannot_be_told_is_told(repository, monkeypatch, name):
    spoil, told = NONE[name]
    spoil(repository)
    monkeypatch.setattr(git, "_PATIENCE", 0.5 if name == "a pipe" else 30)
    begun = time.monotonic()
    found = look(repository)
    assert time.monotonic() - begun < 30
    if told is None:
        assert found is None
    elif told == "":
        assert found.said["commit"] is None and found.diff == b"" and "told" not in found.said
    else:
        assert (found.said["told"], found.diff) == (told, b"")


def test_a_machine_without_git_says_so(repository, monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert look(repository) == Tree({"told": "git is not installed"})
    assert not is_tracked(repository, repository / "a.py")


def test_a_diff_is_bounded(repository, monkeypatch):
    (repository / "a.py").write_text("a = 2\n" * 1000)
    monkeypatch.setattr(git, "MOST_DIFF", 500)
    tree = look(repository)
    assert not tree.said["clean"] and tree.diff == b""
    assert tree.said["told"] == "git diff says more than 500 bytes, which are not kept"


TRAPS = {
    "core.fsmonitor": ("status",),
    "core.hooksPath": ("add", "."),
    "diff.external": ("diff",),
    "diff.x.textconv": ("diff",),
    "diff.x.command": ("diff",),
    "filter.x.clean": ("diff",),
    "filter.x.process": ("diff",),
    "filter.a=b.clean": ("diff",),
}


@pytest.mark.parametrize("name", TRAPS)
def test_no_command_of_a_repository_is_run(repository, tmp_path, name):
    trap, sprung = tmp_path / "trap", tmp_path / "sprung"
    trap.write_text(f"#!/bin/sh\ntouch {sprung}\ncat\n")
    trap.chmod(0o755)
    (tmp_path / "hooks").mkdir()
    shutil.copy(trap, tmp_path / "hooks" / "post-index-change")
    value = tmp_path / "hooks" if name == "core.hooksPath" else trap
    driver = "a=b" if "=" in name else "x"
    (repository / ".git" / "info" / "attributes").write_text(f"*.py filter={driver} diff={driver}")
    run(repository, "config", name, str(value))
    if name.startswith("filter"):
        run(repository, "config", f"filter.{driver}.required", "true")
    (repository / "a.py").write_text("a = 2\n")
    tree = look(repository)
    assert not sprung.exists()
    assert b"+a = 2" in tree.diff
    run(repository, *TRAPS[name])  # what git does by itself
    assert sprung.exists()


def test_nothing_is_fetched(repository, tmp_path):
    """A part of a repository is elsewhere; a diff would ask for it, by any program."""
    sprung = tmp_path / "sprung"
    run(repository, "config", "uploadpack.allowFilter", "true")
    run(tmp_path, "clone", "-q", "--no-local", "--filter=blob:none", f"file://{repository}", "part")
    part = tmp_path / "part"
    (part / "a.py").write_text("a = 2\n")
    for pack in [*(part / ".git" / "objects" / "pack").glob("*.idx")]:
        if " blob " in run(part, "verify-pack", "-v", str(pack)):
            for path in pack.parent.glob(f"{pack.stem}.*"):
                path.unlink()
    trap = tmp_path / "trap"
    trap.write_text(f"#!/bin/sh\ntouch {sprung}\nexit 1\n")
    trap.chmod(0o755)
    run(part, "config", "remote.origin.url", f"ext::{trap}")
    run(part, "config", "protocol.ext.allow", "always")
    assert look(part).said["told"] == "git diff fails with exit code 128"
    assert not sprung.exists()
    run(part, "diff")
    assert sprung.exists()


def test_files_elsewhere_are_not_looked_at(repository, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "a.py").write_text("a secret\n")
    run(repository, "config", "core.worktree", str(tmp_path / "elsewhere"))
    tree = look(repository)
    assert tree.said["clean"] and b"secret" not in tree.diff
    assert "secret" in run(repository, "diff")


def test_its_index_is_not_written(repository):
    index = repository / ".git" / "index"
    os.utime(repository / "a.py", (1, 1))
    before = index.read_bytes()
    look(repository)
    assert index.read_bytes() == before


def test_a_look_is_recalled_for_a_while(repository, monkeypatch):
    first = look(repository)
    (repository / "a.py").write_text("a = 2\n")
    assert tree_of(repository) is first
    later = time.monotonic() + 3600
    monkeypatch.setattr(git.time, "monotonic", lambda: later)
    assert not tree_of(repository).said["clean"]
