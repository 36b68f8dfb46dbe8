"""Shared by the tests: searches."""

import numpy as np

from study.search.state import Box

BOX = Box(np.array([-4.0, 1.0, 0.0]), np.array([4.0, 5.0, 2.0]))


def bowl(x):
    return ((x - np.array([0.7, 2.2, 0.3])) ** 2).sum(axis=1)


def candidates(search, box=BOX, objective=bowl, generations=25, seed=0):
    """Everything a search asks for, generation by generation."""
    rng = np.random.default_rng(seed)
    state, seen = search.init(box, 12, generations, rng), []
    for _ in range(generations):
        seen.append(state.candidates)
        state = search.ask(search.tell(state, objective(state.candidates), rng), rng)
    return np.array(seen)
