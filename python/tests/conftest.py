"""What the tests share: the program of the same wheel, and the repository's samples."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

# A shell ignores Ctrl-C in what it starts in the background, as checks may be; the tests of Ctrl-C need it.
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).parents[2]
PROGRAM = Path(sys.executable).with_name("taxel")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Each test runs in a folder of its own, without the user's settings and shapes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TAXEL_CONFIG", os.devnull)
    monkeypatch.setenv("TAXEL_LIBRARY", str(tmp_path / "library"))
    return tmp_path


@pytest.fixture
def samples(folder):
    shutil.copy(ROOT / "examples/recording.csv", folder)
    shutil.copytree(ROOT / "examples/parts", folder / "parts")
    return folder


@pytest.fixture
def program():
    """Runs the program; returns its answers, a list of what its lines of JSON hold."""

    def run(*arguments, lines=()):
        given = "".join(json.dumps(line) + "\n" for line in lines)
        done = subprocess.run([PROGRAM, *map(str, arguments)], input=given, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]

    return run
