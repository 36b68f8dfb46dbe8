"""Tables and messages in the spellings of many recorders, and what stands in them besides."""

import json

import numpy as np
import pytest

from study.cases.library import own_case
from study.errors import StudyError
from study.io.recordings import holds_samples, read_samples

ROWS = [[0.1, 0.5], [0.3, 0.2], [0.7, -0.4]]
LIMITS = {"joint_limits": {name: {"max_velocity": 1.0, "max_acceleration": 2.0} for name in ("left", "right")}}
BODY = "0.1,0.5\n0.3,0.2\n0.7,-0.4\n"


def put(tmp_path, text, name="r.csv"):
    path = tmp_path / name
    path.write_text(text if isinstance(text, str) else json.dumps(text))
    return path


def planned(tmp_path, file, **content):
    put(tmp_path, LIMITS, "l.json")
    return own_case({"waypoints": file.name, "limits": {"from": "l.json"}, **content}, tmp_path / "mine.yaml")


@pytest.mark.parametrize(
    "head",
    [
        "# by hand\nleft,right\n",
        "# by hand, on Monday\nleft,right\n",
        "# one, two\n# three\nleft,right\n",
        "# left,right\n",
        "# by hand\n#left,right\n# rad, rad\n",
        "# left,right\n# 1, 2\n",
        "// by hand\nleft,right\n",
        "% left,right\n",
        "sep=,\nleft,right\n",
        "left,right # names\n",
        '"left","right"\n',
        "left,right,\n",
    ],
)
def test_the_header_is_the_line_of_names_and_no_comment_before_it(tmp_path, head):
    samples = read_samples(put(tmp_path, head + BODY))
    assert samples.names == ("left", "right")
    assert samples.positions.tolist() == ROWS


def test_words_in_a_comment_are_no_header_where_the_numbers_are_separated_otherwise(tmp_path):
    assert read_samples(put(tmp_path, "# by hand\n" + BODY)).names == ()
    samples = read_samples(put(tmp_path, "# left,right\n" + BODY))
    assert "a comment was taken as the header" in " ".join(samples.notes)


def test_words_beside_numbers_are_left_out_with_a_note_and_dates_are_times(tmp_path):
    text = "date,left,right,label,spare\n" + "".join(
        f"2026-03-01T10:00:0{k}.5,{a},{b},p{k},\n" for k, (a, b) in enumerate(ROWS)
    )
    samples = read_samples(put(tmp_path, text.replace("date", "timestamp")))
    assert samples.times.tolist() == [0, 1, 2]
    assert samples.positions.tolist() == ROWS
    assert "'label', 'spare', which holds no numbers" in " ".join(samples.notes)
    for bad in ("start,0.1\nend,0.2\n", "left,right\n1,1.234,5\n"):
        with pytest.raises(StudyError):
            read_samples(put(tmp_path, bad))


@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("__time", 1.0),
        ("time_ms", 1e-3),
        ("Timestamp_us", 1e-6),
        ("t [ns]", 1e-9),
        ("elapsed_s", 1.0),
        ("ros_time", 1.0),
    ],
)
def test_more_names_of_the_time_and_their_units(tmp_path, name, step):
    text = f"{name},left,right\n" + "".join(f"{k},{a},{b}\n" for k, (a, b) in enumerate(ROWS))
    samples = read_samples(put(tmp_path, text))
    assert np.diff(samples.times) == pytest.approx(step)


def test_times_since_1970_in_nanoseconds_are_said(tmp_path):
    text = "timestamp,left,right\n" + "".join(
        f"{1_700_000_000_000_000_000 + k * 10**9},{a},{b}\n" for k, (a, b) in enumerate(ROWS)
    )
    samples = read_samples(put(tmp_path, text))
    assert np.diff(samples.times) == pytest.approx(1.0)
    assert "since 1970" in samples.notes[0]


def test_a_second_column_of_times_and_a_doubled_joint_are_named(tmp_path):
    text = "time_ms,stamp,left,right,left\n" + "".join(f"{k * 10},{k},{a},{b},9\n" for k, (a, b) in enumerate(ROWS))
    samples = read_samples(put(tmp_path, text))
    assert samples.times.tolist() == [0, 0.01, 0.02]
    assert samples.notes == ("not used: column 'stamp', 'left'",)


@pytest.mark.parametrize(
    "head",
    [
        "/joint_states/left/position,/joint_states/right/position,/joint_states/left/velocity,/joint_states/right/velocity",
        "left.pos,right.pos,left.vel,right.vel",
        "left,right,velocity of left,velocity of right",
        "q1,q2,dq1,dq2",
        "q1,q2,qd1,qd2",
        "position[0],position[1],velocity[0],velocity[1]",
        "joint_pos_0,joint_pos_1,joint_vel_0,joint_vel_1",
        "target_q_0,target_q_1,target_qd_0,target_qd_1",
    ],
)
def test_rates_belong_to_the_joints_that_their_names_say(tmp_path, head):
    text = head + "\n" + "".join(f"{a},{b},{k},{-k}\n" for k, (a, b) in enumerate(ROWS))
    samples = read_samples(put(tmp_path, text))
    assert samples.positions.tolist() == ROWS
    assert samples.velocities.tolist() == [[0, 0], [1, -1], [2, -2]]
    assert samples.names in (("left", "right"), tuple(head.split(",")[:2]))


def test_numbered_columns_are_taken_in_order_with_a_note_and_pandas_index_is_left_out(tmp_path):
    text = ",q1,q2\n" + "".join(f"{k},{a},{b}\n" for k, (a, b) in enumerate(ROWS))
    case = planned(tmp_path, put(tmp_path, text), units="rad")
    assert case.problem.joint_names == ("left", "right")
    said = " ".join(case.warnings)
    for part in ("not used: column ''", "'q1' to 'q2' are numbered", "in the order of the limits: left, right"):
        assert part in said


def test_units_in_the_header_are_the_case_s(tmp_path):
    path = put(tmp_path, "Time [s],left [deg],right [rad]\n0,180,0\n1,90,1\n")
    case = planned(tmp_path, path)
    assert case.problem.waypoints.ravel() == pytest.approx([np.pi, 0, np.pi / 2, 1])
    with pytest.raises(StudyError, match=r"column 'left \[deg\]' is in deg"):
        planned(tmp_path, path, units="rad")


def test_a_still_joint_without_limits_is_left_out_and_a_moving_one_is_asked_about(tmp_path):
    text = "left,right,grip\n" + "".join(f"{a},{b},0.04\n" for a, b in ROWS)
    case = planned(tmp_path, put(tmp_path, text), units="rad")
    assert case.problem.joint_names == ("left", "right")
    assert any("'grip', which stands still" in note for note in case.warnings)
    moving = put(tmp_path, text.replace("0.04\n0.7", "0.03\n0.7"), "m.csv")
    with pytest.raises(StudyError, match=r"no limits for joint .grip..*--joints"):
        planned(tmp_path, moving, units="rad")
    case = planned(tmp_path, moving, units="rad", joints=["right", "left"])
    assert case.problem.waypoints[:, 0].tolist() == [row[1] for row in ROWS]
    assert "m.csv: not used: column 'grip', not among the joints" in case.warnings


@pytest.mark.parametrize(
    ("name", "content"),
    {
        "columns": ("r.json", {"time": [0, 1, 2], "left": [0.1, 0.3, 0.7], "right": [0.5, 0.2, -0.4]}),
        "records": ("r.json", [{"left": a, "right": b} for a, b in ROWS]),
        "lines": ("r.jsonl", "".join(f'{{"left": {a}, "right": {b}}}\n' for a, b in ROWS)),
        "lines in json": (
            "r.json",
            "".join(f'{{"name": ["left", "right"], "position": [{a}, {b}]}}\n' for a, b in ROWS),
        ),
        "arrays": ("r.json", {"positions": ROWS, "joint_names": ["left", "right"], "units": "rad"}),
        "printed": ("r.txt", "---\n".join(f"name: [left, right]\nposition: [{a}, {b}]\n" for a, b in ROWS) + "---\n"),
    }.values(),
)
def test_documents_of_other_shapes(tmp_path, name, content):
    path = put(tmp_path, content, name)
    assert holds_samples(path)
    samples = read_samples(path)
    assert samples.names == ("left", "right")
    assert samples.positions.tolist() == ROWS


def test_a_displayed_trajectory_with_its_empty_part_for_frames(tmp_path):
    points = [{"positions": row, "velocities": [], "effort": [1, 2], "velocites": [0]} for row in ROWS]
    empty = {"joint_names": [], "points": []}
    frames = {"joint_names": ["base"], "points": [{"transforms": [{}]}]}
    for other, sentences in ((empty, 0), (frames, 1)):
        robot = {
            "joint_trajectory": {"joint_names": ["left", "right"], "points": points},
            "multi_dof_joint_trajectory": other,
        }
        samples = read_samples(put(tmp_path, {"trajectory": [robot]}, "d.json"))
        assert samples.positions.tolist() == ROWS
        assert sum("several degrees of freedom" in note for note in samples.notes) == sentences
        assert "not used: key 'velocites' of the message; did you mean 'velocities'?" in samples.notes


def test_states_of_the_arm_are_picked_out_of_a_stream_and_rates_of_single_points_named(tmp_path):
    grip = {"name": ["grip"], "position": [1.0]}
    states = [state for row in ROWS for state in (grip, {"name": ["left", "right"], "position": row}, grip)]
    samples = read_samples(put(tmp_path, states, "s.json"))
    assert samples.positions.tolist() == ROWS
    assert samples.notes == ("not used: 6 joint states of grip",)
    points = [{"positions": row} for row in ROWS]
    points[0]["velocities"] = [0.3, 0.0]
    samples = read_samples(put(tmp_path, {"joint_names": ["left", "right"], "points": points}, "m.json"))
    assert "velocities of 1 point, which not all points have; for a motion that begins" in samples.notes[0]


def test_joint_states_with_a_strange_header_or_beside_a_thing_with_a_name_and_a_position(tmp_path):
    state = {"header": [0.0], "name": ["a", "b"], "position": [0.5, 0.2]}
    path = tmp_path / "states.json"
    path.write_text(
        json.dumps([{"name": 3, "position": 1}, state, {**state, "header": "now"}, {"name": "x", "position": []}])
    )
    samples = read_samples(path)
    assert samples.times is None
    assert samples.positions.tolist() == [[0.5, 0.2]] * 2


def test_an_end_asked_to_be_smooth_without_a_jerk_limit_is_said(tmp_path):
    content = {"units": "rad", "waypoints": ROWS, "end": "smooth"}
    case = own_case(content | {"limits": {"velocity": 1, "acceleration": 2}}, tmp_path / "a.yaml")
    assert any("needs a jerk limit" in note for note in case.warnings)
    case = own_case(content | {"limits": {"velocity": 1, "acceleration": 2, "jerk": 9}}, tmp_path / "a.yaml")
    assert case.warnings == ()


@pytest.mark.parametrize(("limit", "given"), [("3.1416", "rad"), ("3.1415", "rad"), ("180", "deg"), ("179.995", "deg")])
def test_half_a_turn_is_not_outside_its_own_rounding(tmp_path, limit, given):
    end = {"rad": np.pi, "deg": 180.0}[given]
    limits = {"velocity": 90, "acceleration": 90, "position": {"lower": -float(limit), "upper": float(limit)}}
    for value in (end, 3.1416 if given == "rad" else 180.0):
        case = own_case({"units": given, "waypoints": [[0.0], [value]], "limits": limits}, tmp_path / "a.yaml")
        assert case.problem.waypoints.max() <= case.problem.limits.upper[0]


def test_mistakes_about_one_joint_name_it_and_use_the_file_s_units(tmp_path):
    content = {"units": "deg", "joints": ["elbow"], "waypoints": [[0.0], [9.0]]}
    rates = {"velocity": 10, "acceleration": 10}
    for more, sentence in (
        (
            {"limits": rates | {"position": {"lower": 3, "upper": 1}}},
            "limits of joint 'elbow' are empty: lower 3 deg, upper 1 deg",
        ),
        (
            {"limits": rates, "start": {"velocity": [30]}},
            "end velocity of joint 'elbow', 30 deg/s, is beyond its limits",
        ),
    ):
        with pytest.raises(StudyError, match=sentence):
            own_case(content | more, tmp_path / "a.yaml")
