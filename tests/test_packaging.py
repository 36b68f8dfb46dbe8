import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml

from study.cases.suites import suite_named
from study.reproduction.papers_table import papers_in_markdown
from study.suites.law import law_in_markdown

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
CONSTRAINTS = (ROOT / "constraints.txt").read_text().splitlines()
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def command(name: str) -> list[str]:
    """Lines between the marks of a command in the README."""
    block = re.search(rf"<!-- {name} -->\n```\n(.*?)```\n<!-- /{name} -->", README, re.DOTALL)
    assert block
    return block[1].strip().splitlines()


def normal(requirement: str) -> str:
    return re.split(r"[^A-Za-z0-9._-]", requirement)[0].lower().replace("_", "-").replace(".", "-")


@pytest.mark.parametrize("name", ["run-command", "test-command"])
def test_readme_commands_are_one_line_each_with_only_python_present(name):
    (line,) = command(name)
    assert line.startswith("python3 -m venv .venv && .venv/bin/pip install -q -c constraints.txt ")
    assert "http" not in line


def test_ci_takes_the_commands_from_the_readme():
    script = (ROOT / ".ci" / "run").read_text()
    assert os.access(ROOT / ".ci" / "run", os.X_OK)
    for name in ("run-command", "test-command"):
        assert f"$(readme_command {name})" in script
        assert command(name)[0] not in script


def python_blocks() -> list[str]:
    return re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_the_readme_planner_is_a_planner(tiny_problem):
    from study import judge
    from study.planning import RunSettings

    names: dict[str, type] = {}
    exec(python_blocks()[1], names)
    plan = names["MyPlanner"]().plan(tiny_problem, RunSettings("poly353"))
    assert judge(tiny_problem, plan.motion).feasible


def test_constraints_are_exact_versions_of_everything_and_name_no_index():
    line = re.compile(r"[A-Za-z0-9._-]+==[A-Za-z0-9._+!-]+( ; python_version (<|>=) '3\.1\d')?")
    assert not [text for text in CONSTRAINTS if not line.fullmatch(text)]
    pinned = {normal(line) for line in CONSTRAINTS}
    wanted = [*PROJECT["dependencies"], *(r for extra in PROJECT["optional-dependencies"].values() for r in extra)]
    assert not {normal(requirement) for requirement in wanted} - pinned


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Build the wheel as pip would, without a network."""
    folder = tmp_path_factory.mktemp("wheel")
    arguments = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run(arguments, check=True, capture_output=True, timeout=100)
    (path,) = folder.glob("*.whl")
    return path


def release(source: Path, folder: Path) -> dict[str, bytes]:
    """Build both release files of a folder at a stated date, without a network."""
    arguments = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(source)]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "PIP_NO_INDEX": "1"}
    subprocess.run(arguments, check=True, capture_output=True, timeout=100, env=environment)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.slow
def test_release_files_of_two_copies_are_the_same_bytes(tmp_path):
    files = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    copies = [tmp_path / "a copy", tmp_path / "another" / "place"]
    for number, copy in enumerate(copies):
        for name in files if number else reversed(files):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes((ROOT / name).read_bytes())
            os.utime(copy / name, (1e9 + 1e6 * number, 1e9 + 1e6 * number))
    first, second = (release(copy, tmp_path / f"dist{k}") for k, copy in enumerate(copies))
    assert {name.rpartition(".")[2] for name in first} == {"whl", "gz"}
    assert first == second


def test_the_wheel_holds_packages_data_templates_and_nothing_else(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.partition("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"study", "baselines"}
    for path in (ROOT / "data").rglob("*.yaml"):
        assert f"study/data/{path.relative_to(ROOT / 'data').as_posix()}" in names
    for path in (ROOT / "study").rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            assert path.relative_to(ROOT).as_posix() in names


def test_an_installed_wheel_runs_from_another_folder(wheel, tmp_path):
    target = tmp_path / "site"
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        "--target",
        str(target),
        str(wheel),
    ]
    subprocess.run(install, check=True, capture_output=True, timeout=100)
    code = (
        "import study, study.datafiles; from pathlib import Path; "
        "print(Path(study.__file__).parent); print(study.datafiles.data_folder()); "
        "import sys; sys.argv = ['study', 'run', '--cases', 'woodworking', '--planners', 'pso,ruckig-stops', "
        "'--seeds', '1', '--evaluations', '100', '--jobs', '1', '--no-report']; from study.cli.main import main; main()"
    )
    environment = {**os.environ, "PYTHONPATH": str(target)}
    ended = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=100
    )
    assert ended.returncode == 0, ended.stderr
    package, data, *_ = ended.stdout.splitlines()
    assert Path(package) == target / "study"
    assert Path(data) == target / "study" / "data"
    assert "ruckig-stops" in ended.stdout
    assert (tmp_path / "study-output" / "results.sqlite").exists()


def test_every_extra_is_described():
    page = (ROOT / "docs" / "pages" / "installation.md").read_text()
    assert not {name for name in PROJECT["optional-dependencies"] if f"`{name}`" not in page}


def test_the_readme_counts_the_committed_verdicts_and_the_citation_names_this_version():
    assert f"<!-- papers -->\n{papers_in_markdown()}\n<!-- /papers -->" in README
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == PROJECT["version"]
    for target in re.findall(r"\]\(((?!https?:)[^)#]+)", README):
        assert (ROOT / target).exists(), target


def test_the_readme_tells_the_law_of_the_committed_runs():
    law = law_in_markdown([suite_named("scaling"), suite_named("scaling-second")])
    assert f"<!-- law -->\n{law}\n<!-- /law -->" in README
