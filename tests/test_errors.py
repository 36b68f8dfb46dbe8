from study.errors import StudyError, unknown


def test_the_nearest_name_is_offered():
    error = unknown("planner", "gold-pso", ["pso", "golds-pso"])
    assert isinstance(error, StudyError)
    assert str(error) == "no planner 'gold-pso'; did you mean 'golds-pso'? known: golds-pso, pso"


def test_names_unlike_any_get_the_list_alone():
    assert str(unknown("case", "zzz", ["a"])) == "no case 'zzz'; known: a"
    assert str(unknown("case", "zzz", [])) == "no case 'zzz'; known: none"
