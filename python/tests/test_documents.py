"""Every block of the page and every example runs."""

import subprocess
import sys

import pytest
from conftest import ROOT

PAGE = (ROOT / "docs/python.md").read_text(encoding="utf-8")
INSOLE = ROOT.parent / "shared/reference/data/pressuRe/fscan_testL.asf"


def test_the_blocks_of_the_page_run_one_after_the_other(samples, monkeypatch, capsys):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    pytest.importorskip("matplotlib")
    pytest.importorskip("sklearn")
    blocks = [block.split("```")[0] for block in PAGE.split("```python\n")[1:]]
    assert len(blocks) == 7 and len(PAGE.split()) <= 900
    own = {}
    for block in blocks:
        exec(block, own)
    said = capsys.readouterr().out
    assert "imprints in 24000 poses" in said and said.count(" nut\n") + said.count(" other\n") + said.count(" None\n") >= 3
    assert (samples / "often.png").stat().st_size > 1000
    assert 0 < own["model"].error < 0.2


def test_the_block_of_the_readme_prints_what_it_says(capsys):
    block = (ROOT / "README.md").read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(block, {})
    assert capsys.readouterr().out == "12\n"


def output_of(name, *arguments):
    program = [sys.executable, ROOT / "examples/python" / name, *arguments]
    done = subprocess.run(program, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_an_atlas_is_an_array():
    printed = output_of("atlas.py")
    assert "406 imprints in 24000 poses, an array of (406, 16, 16)" in printed
    assert "active taxels: 23.03 ± 1.06; the continuous hexagon covers 23.38 cells" in printed


def test_no_classifier_passes_the_limit():
    pytest.importorskip("sklearn")
    *_, tree, limit = output_of("classifier.py").splitlines()
    assert float(limit.split()[-1]) < float(tree.split()[-2])


def test_live_frames_are_named():
    printed = output_of("live.py")
    assert printed.startswith("frame 0: no contact\n")
    assert [printed.count(f": {name} (certain)\n") for name in ("disc", "bar")] == [12, 12]
    recorded = output_of("live.py", ROOT / "examples/recording.csv")
    assert ": no contact\n" in recorded and " taxels at " in recorded


@pytest.mark.skipif(not INSOLE.exists(), reason=f"there is no recording of an insole at {INSOLE}")
def test_real_footsteps_are_named():
    *steps, last = output_of("footsteps.py", INSOLE).splitlines()
    # The recording is of a left foot. Each step begins with the heel, then the whole foot follows, then the ball.
    assert sum(": left heel, left whole, left ball" in step for step in steps) == 5
    assert int(last.split()[0]) >= 95 and " of 102 frames" in last
