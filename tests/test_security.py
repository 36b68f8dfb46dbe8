"""What a file from someone else, or a name in it, may not do."""

import ast
import re
from pathlib import Path

import pytest
import yaml

from study.cases.library import load_case
from study.errors import StudyError
from study.io.filenames import file_stem
from tests.conftest import CASE_FILE

ROOT = Path(__file__).parent.parent
SOURCES = sorted(path for folder in ("study", "baselines") for path in (ROOT / folder).rglob("*.py"))
NAMES = [
    "../../escaped",
    "/escaped",
    "..",
    ".",
    "a/../../escaped",
    "..\\..\\escaped",
    "C:\\escaped",
    "con",
    "<script>alert(1)</script>",
    "-rf",
    "x\u202egnp",
    "a\nb",
    "~/escaped",
    "$(escaped)",
]


def called(node):
    """Name of what a call calls, with its module if it is written so."""
    return ast.unparse(node.func) if isinstance(node, ast.Call) else ""


def test_no_source_evaluates_text_unpickles_files_or_asks_a_shell():
    banned = re.compile(
        r"^(eval|exec|compile|__import__|os\.system|os\.popen|(c?pickle|dill|joblib|marshal|shelve)\.\w+|"
        r"yaml\.(load|full_load|unsafe_load)(_all)?|(pd|pandas)\.read_pickle|tarfile\.\w+|shutil\.unpack_archive)$"
    )
    found = []
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text())):
            options = {word.arg: ast.unparse(word.value) for word in getattr(node, "keywords", [])}
            if isinstance(node, ast.Call) and (
                banned.match(called(node)) or "True" in (options.get("shell"), options.get("allow_pickle"))
            ):
                found.append(f"{path.relative_to(ROOT)}:{node.lineno} {called(node)}")
    assert found == []


def test_every_server_of_ours_listens_on_this_machine_alone():
    everywhere = re.compile(r"0\.0\.0\.0|[\"']::[\"']|host\s*=\s*[\"']{2}")
    assert [path.name for path in SOURCES if everywhere.search(path.read_text())] == []


@pytest.mark.parametrize("name", NAMES)
def test_no_name_leads_out_of_a_folder(tmp_path, name):
    path = tmp_path / f"{file_stem(name)}.rrd"
    assert path.resolve().parent == tmp_path.resolve()
    assert re.fullmatch(r"[A-Za-z0-9_.-]+", file_stem(name))
    path.write_text("can be written")


ALIKE = [
    "a/b",
    "a_b",
    "a-b",
    "a b",
    "A-B",
    "A_b",
    "a\\b",
    "a-b.",
    "-a-b",
    "ä-b",
    "index",
    "Index",
    "all",
    "x" * 300,
    "x" * 301,
    "",
]


def test_names_that_look_alike_have_files_of_their_own_and_plain_names_stay():
    alike = [*ALIKE, *NAMES, *(file_stem(name) for name in ALIKE)]
    stems = [file_stem(name).lower() for name in dict.fromkeys(alike)]  # many disks do not tell case apart
    assert len(set(stems)) == len(stems)
    assert max(map(len, stems)) < 100
    assert not {"con", "aux", "index", "all"} & {file_stem(name) for name in ("con", "aux", "index", "all")}
    for name in ("woodworking", "ur5-bspline", "my_case", "a.b"):
        assert file_stem(name) == name


@pytest.mark.parametrize(
    "tag", ["!!python/object/apply:os.system ['true']", "!!python/name:os.system", "!!python/module:os"]
)
def test_a_case_file_builds_no_python_objects(tmp_path, tag):
    path = tmp_path / "case.yaml"
    path.write_text(CASE_FILE.replace("title: A case of one's own", f"title: {tag}"))
    with pytest.raises(StudyError, match="could not determine a constructor"):
        load_case(str(path))


@pytest.mark.timeout(240)
def test_a_run_of_cases_with_hostile_names_writes_in_its_folder_only_and_escapes_html(study_command, stubs, tmp_path):
    document = yaml.safe_load(CASE_FILE)
    files = []
    for k, name in enumerate(("../../escaped", "<script>alert(1)</script>")):
        files.append(tmp_path / f"case{k}.yaml")
        files[-1].write_text(yaml.safe_dump({**document, "name": name, "title": "<img src=x onerror=alert(1)>"}))
    out = tmp_path / "deep" / "inside" / "out"
    listed = ",".join(map(str, files))
    ended = study_command("run", "--cases", listed, "--planners", "stub-steady", "--seeds", 1, "--out", out)
    if ended.returncode == 2:  # a name may be refused, in one sentence
        assert "name" in ended.stderr
    else:
        assert ended.returncode == 0, ended.stderr
        pages = [page.read_text() for page in (out / "report").rglob("*.html")]
        assert pages
        assert not [page for page in pages if "<script>alert" in page or "<img src=x" in page]
    outside = {path for path in tmp_path.rglob("*") if path.is_file() and out not in path.parents}
    assert outside == set(files)
    assert not list(tmp_path.parent.glob("*escaped*"))
