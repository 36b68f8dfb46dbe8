"""Ruckig's way of via several points asks a remote server: no source uses it, and planning opens no socket."""

import socket
from pathlib import Path

import pytest

import baselines
import study
from baselines.state_to_state.stops import RuckigStops
from baselines.state_to_state.via import RuckigVia
from study.planning import RunSettings, Status
from tests.helpers.reference_problems import woodworking

FORBIDDEN = "_".join(["intermediate", "positions"])


@pytest.mark.parametrize("package", [study, baselines])
def test_no_source_names_the_remote_service(package):
    files = sorted(Path(package.__file__).parent.rglob("*.py"))
    assert files
    named = [
        path.name
        for path in files
        for word in (FORBIDDEN, "intermediate_", "filter_intermediate", "max_number_of_waypoints")
        if word in path.read_text()
    ]
    assert not named


@pytest.mark.parametrize("planner", [RuckigStops(), RuckigVia(pieces=2, rounds=5)])
def test_planning_opens_no_socket(planner, monkeypatch):
    def refuse(*args, **kwargs):
        raise AssertionError("a planner opened a socket")

    for name in ("socket", "create_connection", "getaddrinfo"):
        monkeypatch.setattr(socket, name, refuse)
    with pytest.raises(AssertionError, match="opened a socket"):
        socket.create_connection(("localhost", 1))
    assert planner.plan(woodworking(), RunSettings("cubic-spline")).status is Status.FINISHED
