"""Small arms with masses, whose torques are known in closed form."""

import numpy as np

from study.mechanism import Mechanism

G = 9.81


def chain(origins, masses, centres, sliding=None, inertias=None, **parts):
    """Joints at origins of shape (n, 4, 4); masses at places in their joint's frame; gravity down along z of the base."""
    n = len(origins)
    zero = np.zeros(n)
    given = {"rotors": zero, "viscous": zero, "coulomb": zero, "gravity": [0.0, 0.0, -G]} | parts
    bodies = np.zeros((n, 3, 3)) if inertias is None else inertias
    return Mechanism(np.array(origins), zero if sliding is None else sliding, masses, centres, bodies, **given)


def placed(place, sideways=False):
    """Origin of a joint; sideways, its axis is the base's -y, so that positive angles lift x towards z."""
    result = np.eye(4)
    if sideways:
        result[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    result[:3, 3] = place
    return result


def pendulum(mass=2.0, length=0.5, **parts):
    """A point mass on a massless rod that turns in a vertical plane; at angle 0 it is level."""
    tool = placed([length, 0, 0])
    return chain([placed([0, 0, 0], sideways=True)], [mass], [[length, 0, 0]], **{"tool": tool} | parts)


def two_links(masses=(3.0, 2.0), lengths=(0.5, 0.4), **parts):
    """Two point masses at the ends of massless links in a vertical plane."""
    centres = [[length, 0, 0] for length in lengths]
    origins = [placed([0, 0, 0], sideways=True), placed([lengths[0], 0, 0])]
    return chain(origins, masses, centres, **{"tool": placed([lengths[1], 0, 0])} | parts)


def lift(mass=5.0, **parts):
    """A mass on a joint that slides upwards."""
    return chain([np.eye(4)], [mass], [[0, 0, 0]], sliding=[1.0], **parts)


def random_arm(rng, n_joints):
    """Any arm: axes and bodies anywhere, some joints sliding."""
    origins = np.tile(np.eye(4), (n_joints + 1, 1, 1))
    for origin in origins:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        origin[:3, :3] = turn * np.linalg.det(turn)
        origin[:3, 3] = rng.normal(size=3)
    roots = rng.normal(size=(n_joints, 3, 3))
    return Mechanism(
        origins[:-1],
        rng.integers(0, 2, n_joints),
        rng.uniform(0, 3, n_joints),
        rng.normal(size=(n_joints, 3)),
        roots @ np.swapaxes(roots, 1, 2),
        *rng.uniform(size=(3, n_joints)),
        rng.normal(size=3),
        origins[-1],
    )
