import os
import re
import shutil
import subprocess

import pytest

from tests.conftest import command

GUARD = '''
"""Forbid every socket that is not on this machine, in every process that Python starts; note each attempt."""

import os
import sys

ALLOWED = ("127.", "::1", "localhost")


def guard(event, arguments):
    if event in ("socket.connect", "socket.bind", "socket.sendto"):
        address = arguments[1]
        outside = isinstance(address, tuple) and not str(address[0]).startswith(ALLOWED)
    elif event in ("socket.getaddrinfo", "socket.gethostbyname"):
        outside = not str(arguments[0]).startswith(ALLOWED)
    else:
        return
    if outside:
        with open(os.environ["SOCKET_LOG"], "a") as log:
            print(event, arguments[1:] if event == "socket.connect" else arguments, file=log)
        raise PermissionError(f"{event} beyond this machine")


sys.addaudithook(guard)
with open(os.environ["SOCKET_LOG"], "a") as log:
    print("guarded", os.getpid(), file=log)
'''
CONNECT = re.compile(
    r"(?:connect|sendto|sendmsg|bind)\(.*sa_family=(AF_INET6?).*?(?:inet_addr\(\"|inet_pton\(AF_INET6, \")([^\"]+)"
)


@pytest.fixture
def guarded(tmp_path, stubs):
    """Environment in which every Python process watches its sockets, and the file where they note what they saw."""
    (tmp_path / "guard").mkdir()
    (tmp_path / "guard" / "sitecustomize.py").write_text(GUARD)
    log = tmp_path / "sockets.log"
    paths = os.pathsep.join([str(tmp_path / "guard"), os.environ["PYTHONPATH"]])
    return {**os.environ, "PYTHONPATH": paths, "SOCKET_LOG": str(log)}, log


def test_the_guard_sees_a_connection_from_a_worker(guarded, case_file, tmp_path):
    environment, log = guarded
    arguments = [
        "--cases",
        case_file,
        "--planners",
        "stub-socket",
        "--seeds",
        1,
        "--out",
        tmp_path / "o",
        "--no-report",
    ]
    ended = subprocess.run(command("run", *arguments), env=environment, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stderr
    assert "PermissionError:" in ended.stdout
    assert "192.0.2.1" in log.read_text()


RUN = [
    "--cases",
    "woodworking",
    "--planners",
    "golds-pso,casadi-nlp,toppra,ruckig-stops",
    "--seeds",
    1,
    "--evaluations",
    200,
]


@pytest.mark.slow
def test_a_run_with_report_and_recording_stays_on_this_machine(guarded, tmp_path):
    environment, log = guarded
    arguments = command("run", *RUN, "--jobs", 2, "--out", tmp_path / "o")
    ended = subprocess.run(arguments, env=environment, capture_output=True, text=True, timeout=100)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "o" / "report" / "index.html").exists()
    assert (tmp_path / "o" / "recordings" / "woodworking.rrd").exists()
    lines = log.read_text().splitlines()
    assert len([line for line in lines if line.startswith("guarded")]) >= 3  # the run and two workers
    assert not [line for line in lines if not line.startswith("guarded")]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("strace") is None, reason="strace is not installed")
def test_no_native_code_reaches_the_network_either(tmp_path):
    log = tmp_path / "trace"
    few = ["--seccomp-bpf", "-e", "trace=connect,bind,sendto,sendmsg"]  # no other call is stopped at, which takes long
    trace = ["strace", "-f", "-qq", *few, "-o", str(log)]
    ended = subprocess.run(
        [*trace, *command("run", *RUN, "--jobs", 1, "--out", tmp_path / "o")],
        capture_output=True,
        text=True,
        timeout=110,
    )
    if "ptrace" in ended.stderr:
        pytest.skip("tracing is not allowed here")
    assert ended.returncode == 0, ended.stderr
    assert not beyond(log.read_text())


def beyond(trace: str) -> list[str]:
    """Addresses beyond this machine in what strace wrote."""
    return [found[2] for found in CONNECT.finditer(trace) if not found[2].startswith(("127.", "::1"))]


def test_the_trace_is_read_rightly():
    trace = (
        '12 connect(3, {sa_family=AF_INET, sin_port=htons(80), sin_addr=inet_addr("192.0.2.1")}, 16) = -1\n'
        '12 connect(3, {sa_family=AF_INET, sin_port=htons(80), sin_addr=inet_addr("127.0.0.1")}, 16) = 0\n'
        '12 connect(3, {sa_family=AF_UNIX, sun_path="/x"}, 16) = 0\n'
        '12 connect(3, {sa_family=AF_INET6, sin6_port=htons(80), inet_pton(AF_INET6, "2001:db8::1", &sin6_addr)}, 28) = -1\n'
    )
    assert beyond(trace) == ["192.0.2.1", "2001:db8::1"]
