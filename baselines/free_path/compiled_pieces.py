"""The compiled variant of the pieces' rows; importing this file imports numba.

It follows `baselines.free_path.pieces` equation by equation, one segment and joint after the other, so that both give
the same numbers to rounding.
"""

from __future__ import annotations

import numpy as np

from baselines.free_path.compiled_algebra import kernel
from baselines.free_path.pieces import Costates, Pieces, Point
from baselines.free_path.question import Flags, Integers
from baselines.free_path.rows import Rows
from study.problem import Floats

U, SLOPE, MIDDLE, WIDTH, EARLY, LATE = range(6)
Gains = tuple[Floats, Floats]


@kernel
def _values(y: Floats, c1: float, c2: float, values: Floats) -> None:
    """Bounded quantities of one piece, the slope among them as a difference."""
    x2, x1, u0, u1, h = y[0], y[1], y[2], y[3], y[4]
    values[U], values[SLOPE], values[MIDDLE], values[WIDTH] = u1, u1 - u0, x1 + c1 * h * u0 / 2, h
    if len(values) > EARLY:
        lift = c2 * h / 3
        values[EARLY], values[LATE] = x2 + lift * x1, x2 + 2 * lift * x1 + c1 * c2 * h * h * u0 / 6


@kernel
def _spread(values: Floats, h: float, bounds: tuple[Floats, Floats], active: Flags, rows: Floats) -> None:
    """Distances of one piece's quantities from their bounds."""
    upper, lower = bounds
    for q in range(len(values)):
        width = h if q == SLOPE else 1.0
        rows[0, q] = upper[q] * width - values[q] if active[0, q] else 1.0
        rows[1, q] = values[q] - lower[q] * width if active[1, q] else 1.0


@kernel
def evaluate(
    point: tuple[Floats, Floats, Floats, Floats],
    program: tuple[Floats, Gains, Floats, Integers],
    bounds: tuple[Floats, Floats, Flags],
    out: tuple[Floats, Floats, Floats],
) -> None:
    """States, rows and what is left of the closing equations; `out` is filled."""
    durations, nodes, inner, widths = point
    ahead, (first, second), closures, kinds = program
    upper, lower, active = bounds
    states, rows, errors = out
    segments, joints, pieces = widths.shape
    values, y = np.empty(rows.shape[1]), np.empty(5)
    for i in range(segments):
        for j in range(joints):
            c1, c2 = first[i, j, 0], second[i, j, 0]
            y[2], y[1], y[0] = nodes[i, j, 0], nodes[i, j, 1], nodes[i, j, 2]
            total = 0.0
            for k in range(pieces):
                y[3] = inner[i, j, k] if k < pieces - 1 else nodes[i + 1, j, 0] + ahead[i, j, 0]
                y[4] = widths[i, j, k]
                states[:, i, j, k] = y
                _values(y, c1, c2, values)
                side = upper[:, i, j, 0], lower[:, i, j, 0]
                _spread(values, y[4], side, active[:, :, i, j, k], rows[:, :, i, j, k])
                h, u0, u1 = y[4], y[2], y[3]
                y[0] += c2 * h * (y[1] + c1 * h * (2 * u0 + u1) / 6)
                y[1] += c1 * h * (u0 + u1) / 2
                y[2] = u1
                total += h
            for row in range(2):
                left = y[1 - row] - nodes[i + 1, j, 1 + row] - ahead[i, j, 1 + row]
                errors[i, j, row] = left / closures[i, j, row] if kinds[j] > row + 1 else 0.0
            errors[i, j, 2] = total - durations[i]


@kernel
def adjoint(
    states: Floats,
    gains: Gains,
    slopes: tuple[Floats, Floats],
    weights: Floats,
    ends: Floats,
    out: tuple[Floats, Floats, Floats, Floats, Floats],
) -> None:
    """Costates of all pieces, from the last to the first; `out` is filled."""
    after1, after2, u, width, start = out
    count, segments, joints, pieces = weights.shape[1:]
    net = np.zeros(6)
    for i in range(segments):
        for j in range(joints):
            c1, c2, up, low = gains[0][i, j, 0], gains[1][i, j, 0], slopes[0][i, j, 0], slopes[1][i, j, 0]
            a1, a2 = ends[i, j, 0], ends[i, j, 1]
            u[i, j, :] = 0.0
            for k in range(pieces - 1, -1, -1):
                x1, u0, u1, h = states[1, i, j, k], states[2, i, j, k], states[3, i, j, k], states[4, i, j, k]
                for q in range(count):
                    net[q] = weights[1, q, i, j, k] - weights[0, q, i, j, k]
                lift, both = c2 * h / 3, c1 * c2 * h
                after1[i, j, k], after2[i, j, k] = a1, a2
                bend, half = both * a2, c1 * a1 / 2
                own = c1 * h / 2 * net[MIDDLE] - net[SLOPE] + both * h / 6 * net[LATE]
                u[i, j, k] += own + h * (half + bend / 3)
                u[i, j, k + 1] += net[U] + net[SLOPE] + h * (half + bend / 6)
                own = c1 * u0 / 2 * net[MIDDLE] + net[WIDTH] + up * weights[0, SLOPE, i, j, k]
                own -= low * weights[1, SLOPE, i, j, k]
                own += c2 * x1 / 3 * (net[EARLY] + 2 * net[LATE]) + both * u0 / 3 * net[LATE]
                width[i, j, k] = own + half * (u0 + u1) + c2 * a2 * x1 + bend * (2 * u0 + u1) / 3
                a1 += net[MIDDLE] + lift * (net[EARLY] + 2 * net[LATE]) + c2 * h * a2
                a2 += net[EARLY] + net[LATE]
            start[i, j, 0], start[i, j, 1] = a1, a2


@kernel
def forward(
    states: Floats,
    gains: Gains,
    bounds: tuple[Floats, Floats, Flags],
    step: tuple[Floats, Floats, Floats],
    rows: Floats,
) -> None:
    """Change of all rows along a step; `rows` is filled."""
    upper, lower, active = bounds
    nodes, inner, widths = step
    count, segments, joints, pieces = rows.shape[1:]
    change = np.empty(6)
    for i in range(segments):
        for j in range(joints):
            c1, c2 = gains[0][i, j, 0], gains[1][i, j, 0]
            du0, dx1, dx2 = nodes[i, j, 0], nodes[i, j, 1], nodes[i, j, 2]
            for k in range(pieces):
                x1, u0, u1, h = states[1, i, j, k], states[2, i, j, k], states[3, i, j, k], states[4, i, j, k]
                du1 = inner[i, j, k] if k < pieces - 1 else nodes[i + 1, j, 0]
                dh, lift, both = widths[i, j, k], c2 * h / 3, c1 * c2 * h
                change[U], change[SLOPE], change[WIDTH] = du1, du1 - du0, dh
                change[MIDDLE] = dx1 + c1 * (h * du0 + u0 * dh) / 2
                change[EARLY] = dx2 + lift * dx1 + c2 * x1 / 3 * dh
                change[LATE] = dx2 + 2 * (lift * dx1 + c2 * x1 / 3 * dh) + both * (u0 * dh / 3 + h * du0 / 6)
                for q in range(count):
                    width = dh if q == SLOPE else 0.0
                    rows[0, q, i, j, k] = upper[q, i, j, 0] * width - change[q] if active[0, q, i, j, k] else 0.0
                    rows[1, q, i, j, k] = change[q] - lower[q, i, j, 0] * width if active[1, q, i, j, k] else 0.0
                dx2 += c2 * (h * dx1 + dh * x1 + c1 * h * (h * (2 * du0 + du1) / 6 + dh * (2 * u0 + u1) / 3))
                dx1 += c1 * (h * (du0 + du1) + dh * (u0 + u1)) / 2
                du0 = du1


@kernel
def _outer(row: Floats, weight: float, total: Floats) -> None:
    """Add the lower triangle of a row's outer product."""
    for a in range(5):
        for b in range(a + 1):
            total[a, b] += weight * row[a] * row[b]


@kernel
def second_derivatives(
    states: Floats,
    gains: Gains,
    slopes: tuple[Floats, Floats],
    given: tuple[Floats, Floats, Floats, Floats],
    total: Floats,
) -> None:
    """Second derivatives of every piece's share in the Lagrangian; `total` is filled."""
    multipliers, stiffness, after1, after2 = given
    count, segments, joints, pieces = stiffness.shape[1:]
    row, net, both = np.zeros(5), np.zeros(6), np.zeros(6)
    for i in range(segments):
        for j in range(joints):
            c1, c2, up, low = gains[0][i, j, 0], gains[1][i, j, 0], slopes[0][i, j, 0], slopes[1][i, j, 0]
            for k in range(pieces):
                x1, u0, u1, h = states[1, i, j, k], states[2, i, j, k], states[3, i, j, k], states[4, i, j, k]
                for q in range(count):
                    net[q] = multipliers[0, q, i, j, k] - multipliers[1, q, i, j, k]
                    both[q] = stiffness[0, q, i, j, k] + stiffness[1, q, i, j, k]
                g, x1s, x2s, cc = total[i, j, k], after1[i, j, k], after2[i, j, k], c1 * c2
                g[:] = 0.0
                row[:] = 0.0
                row[1], row[2], row[4] = 1.0, c1 * h / 2, c1 * u0 / 2
                _outer(row, both[MIDDLE], g)
                if count > EARLY:
                    row[0], row[1], row[2], row[4] = 1.0, c2 * h / 3, 0.0, c2 * x1 / 3
                    _outer(row, both[EARLY], g)
                    row[1], row[2], row[4] = 2 * row[1], cc * h * h / 6, 2 * row[4] + cc * h * u0 / 3
                    _outer(row, both[LATE], g)
                above, below = up * stiffness[0, SLOPE, i, j, k], low * stiffness[1, SLOPE, i, j, k]
                g[2, 2] += both[SLOPE]
                g[3, 2] -= both[SLOPE]
                g[3, 3] += both[SLOPE] + both[U]
                g[4, 1] += c2 * (x2s + (net[EARLY] + 2 * net[LATE]) / 3)
                g[4, 2] += above + below + c1 * (x1s + net[MIDDLE]) / 2 + cc * h * (2 * x2s + net[LATE]) / 3
                g[4, 3] += c1 * x1s / 2 + cc * x2s * h / 3 - above - below
                g[4, 4] += both[WIDTH] + up * above + low * below
                g[4, 4] += cc * (x2s * (2 * u0 + u1) + net[LATE] * u0) / 3


class CompiledRows(Rows):
    """The same rows by compiled loops over the pieces."""

    def at(self, point: Point) -> Pieces:
        """Evaluate everything at a point."""
        model, bounds = self.model, self.bounds
        states, errors = np.empty((5, *model.shape)), np.empty((*model.shape[:2], 3))
        rows = np.empty(len(self.active))
        program = model.ahead, model.gains, model.closures, model.kinds
        sides = bounds.upper, bounds.lower, bounds.active
        evaluate(
            (point.durations, point.nodes, point.inner, point.widths),
            program,
            sides,
            (states, self.pieces(rows), errors),
        )
        self.fill_nodes(rows, point.nodes)
        return Pieces(states, states[:0], rows, errors)

    def change(self, at: Pieces, step: Point) -> Floats:
        """Directional derivative of the rows along a step."""
        rows = np.empty(len(self.active))
        sides = self.bounds.upper, self.bounds.lower, self.bounds.active
        widths = np.ascontiguousarray(step.widths)
        forward(
            at.states,
            self.model.gains,
            sides,
            (step.nodes, np.ascontiguousarray(step.inner), widths),
            self.pieces(rows),
        )
        self.fill_node_changes(rows, step.nodes)
        return rows

    def pull(self, at: Pieces, weights: Floats, ends: Floats) -> Costates:
        """Gradient of the rows' weighted sum plus `ends` times the last x1 and x2."""
        segments, joints, pieces = shape = self.model.shape
        out = Costates(
            np.empty(shape),
            np.empty(shape),
            np.empty((segments, joints, pieces + 1)),
            np.empty(shape),
            np.empty(ends.shape),
        )
        slopes = self.bounds.upper[SLOPE], self.bounds.lower[SLOPE]
        adjoint(
            at.states, self.model.gains, slopes, self.pieces(weights), ends, (out.x1, out.x2, out.u, out.h, out.start)
        )
        return out

    def curvature(self, at: Pieces, multipliers: Floats, stiffness: Floats, costates: Costates) -> Floats:
        """Second derivatives of every piece's share in the Lagrangian, with the barrier's."""
        total = np.empty((*self.model.shape, 5, 5))
        slopes = self.bounds.upper[SLOPE], self.bounds.lower[SLOPE]
        given = self.pieces(multipliers), self.pieces(stiffness), costates.x1, costates.x2
        second_derivatives(at.states, self.model.gains, slopes, given, total)
        return total
