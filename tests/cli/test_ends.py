"""Commands that end early or badly say so in one sentence."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from study.cli.screen import LONGEST, clean
from tests.conftest import command

DURING_AN_IMPORT = """\
import os, signal, sys
import study.cli.commands
study.cli.commands.import_module = lambda name: os.kill(os.getpid(), signal.SIGINT)
sys.argv = ["study", "list"]
from study.__main__ import main
main()
"""


def test_ctrl_c_during_an_import_is_one_sentence():
    ended = subprocess.run([sys.executable, "-c", DURING_AN_IMPORT], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "study: interrupted\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
@pytest.mark.parametrize("arguments", [["list"], ["schema"], ["--help"]])
def test_a_full_output_is_one_sentence(arguments):
    with open("/dev/full", "w") as full:
        ended = subprocess.run(command(*arguments), stdout=full, stderr=subprocess.PIPE, text=True, timeout=100)
    assert ended.returncode == 2
    assert ended.stderr == "study: the output cannot be written: No space left on device\n"


def test_an_output_whose_reader_has_gone_ends_in_silence():
    run = subprocess.Popen(command("list"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    run.stdout.close()
    assert run.stderr.read() == ""
    assert run.wait(100) != 0
    run.stderr.close()


def test_names_steer_no_terminal(study_command, tmp_path):
    case = tmp_path / "c.yaml"
    case.write_text(
        'name: "\\e]0;pwned\\a\\e[31mred"\njoints: ["\\u202egnorw", "b\\rB"]\nunits: rad\nwaypoints: [[0, 0], [1, 1]]\n'
        "limits: {velocity: 1, acceleration: 1}\n"
    )
    said = study_command("check", case).stdout + study_command("plan", case, "--planner", "nobody").stderr
    assert "red" in said
    assert "gnorw" in said
    assert not {"\x1b", "\x07", "\u202e", "\r"} & set(said)


def test_text_of_the_worlds_languages_stays_as_it_is():
    text = "Ellenbogen ü 肘 \N{GREEK SMALL LETTER THETA}\u00a0 {3}\n"
    assert clean(text) == text


def test_a_long_sentence_is_cut_in_the_middle(study_command, tmp_path):
    case = tmp_path / "c.json"
    case.write_text(json.dumps({"units": "rad", "waypoints": [[0], [1]], "limits": {"velocity": 1}, "k" * 5000: 1}))
    ended = study_command("check", case)
    assert ended.returncode == 2
    assert len(ended.stderr) < LONGEST + 50
    assert "unknown key" in ended.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such limits there")
def test_too_little_memory_is_one_sentence(tmp_path):
    limited = ["sh", "-c", 'ulimit -v 250000 && exec "$@"', "sh", *command("plan", tmp_path / "no.yaml")]
    ended = subprocess.run(limited, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 2
    assert ended.stderr.startswith("study: this process may take 256 MB of memory, its libraries need 600 MB")


UNGUARDED = """\
import numpy as np
from study import JointLimits, Problem, plan_many
limits = JointLimits([1.0], [2.0], [10.0])
answers = plan_many([Problem("a", np.array([[0.0], [k]]), limits) for k in (1.0, 2.0)], "ruckig-stops", jobs=2)
print(answers[0].reason)
"""


def test_a_script_without_a_guard_is_told_so_and_starts_no_workers_in_workers(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(UNGUARDED)
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=100)
    assert "Traceback" not in ended.stderr
    assert 'under `if __name__ == "__main__":`' in ended.stderr
    assert 'under `if __name__ == "__main__":`' in ended.stdout


def test_a_home_that_cannot_be_written_to_is_no_noise(tmp_path):
    text = "import sys; sys.argv = ['study', '--version']\nfrom study.__main__ import main\ntry: main()\nexcept SystemExit: import matplotlib.font_manager"
    ended = subprocess.run(
        [sys.executable, "-c", text],
        env={**os.environ, "HOME": "/proc/none", "MPLCONFIGDIR": "", "XDG_CONFIG_HOME": "", "XDG_CACHE_HOME": ""},
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert ended.stderr == ""
