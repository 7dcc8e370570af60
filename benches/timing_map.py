#!/usr/bin/env python3
"""The map of the boundary tooth over speed and tension as a drive engineer would write it without beltspace: numba on all cores.

Same work as a `timing-belt` study with an axis of speeds and one of tight side tensions: every pair of the two on the default belt; per
pair the complete mesh, the centrifugal force and the first tooth that it lifts (N + 2 if none); how many pairs there are of each.

Three ways, which must count alike:
  per_pair     as the paper describes it: solve the mesh of every pair, then walk the teeth until the first one lifts;
  solved_once  the mesh is linear in both strands: solved once for each, so that a pair is left with the walk alone;
  by_crossing  for its counts no pair need be looked at: sorted speeds are cut where the next tooth lifts. Only this model and these
               two axes allow that; it says what a sweep of pairs is up against, not what it is measured by.

    pip install numpy numba
    python timing_map.py [levels]      # levels per axis, default 10000 (1e8 pairs)
"""
import sys
import time

import numba as nb
import numpy as np

TEETH, SLACK = 23, 0.0  # N + 1; N
FRICTION, COMPLIANCE, MODULUS, AREA = 0.45, 2.55e-3, 78.4e3, 21.5  # -, mm/N, MPa, mm2
RADIUS, BETA, PHI, TOOTH = 66.32, np.radians(1.473), np.radians(2.618), 6.10  # mm, mm
ALPHA, OMEGA, PSI = np.radians(20.0), np.radians(6.0), np.radians(6.0)
MASS = 0.411e-3  # kg per pitch

LEFT = np.exp(-2 * FRICTION * BETA)  # of the tension, behind a land
STRETCH = (RADIUS * (1 - LEFT) / FRICTION + TOOTH) / (AREA * MODULUS)
A, C = COMPLIANCE * LEFT * np.cos(PHI), COMPLIANCE * np.cos(PHI)
B = COMPLIANCE * np.cos(PHI) * (1 + LEFT) + STRETCH
ENTRY, EXIT, FLANK, SPACE = np.cos(OMEGA), np.cos(PSI), np.cos(ALPHA), np.cos(PHI)
ACROSS, OUTWARD = np.sin(PHI + BETA), np.sin(ALPHA) - FRICTION * np.cos(ALPHA)


def axes(levels):
    return np.linspace(500.0, 8000.0, levels), np.linspace(60.0, 800.0, levels)


@nb.njit(fastmath=True, inline="always")
def mesh(tight, slack, tension, pivot):
    """Tension behind each tooth: a T(i-1) - b T(i) + c T(i+1) = 0, by elimination of one row after the other."""
    last = TEETH - 2
    pivot[0] = C / B
    tension[0] = COMPLIANCE * ENTRY * tight / B
    for i in range(1, last + 1):
        scale = 1.0 / (B - A * pivot[i - 1])
        pivot[i] = C * scale
        given = COMPLIANCE * EXIT * slack if i == last else 0.0
        tension[i] = (A * tension[i - 1] + given) * scale
    for i in range(last - 1, -1, -1):
        tension[i] += pivot[i] * tension[i + 1]
    tension[last + 1] = slack


@nb.njit(fastmath=True, inline="always")
def inward(tight, tension, i):
    """Force on the pitch of tooth i (from 0) towards the axis."""
    entering = tight if i == 0 else LEFT * tension[i - 1]
    pull = tight * ENTRY if i == 0 else entering * SPACE
    load = (pull - tension[i] * (EXIT if i == TEETH - 1 else SPACE)) / FLANK
    return (entering + tension[i]) * ACROSS - OUTWARD * load


@nb.njit
def centrifugal(speeds):
    return MASS * RADIUS / 1000 * (speeds * np.pi / 30) ** 2


@nb.njit(parallel=True, fastmath=True)
def per_pair(speeds, tensions):
    force = centrifugal(speeds)
    counts = np.zeros((len(tensions), TEETH + 2), np.int64)
    for t in nb.prange(len(tensions)):
        tension, pivot = np.empty(TEETH), np.empty(TEETH)
        for s in range(len(force)):
            mesh(tensions[t], SLACK, tension, pivot)
            i = 0
            while i < TEETH and force[s] <= inward(tensions[t], tension, i):
                i += 1
            counts[t, i + 1] += 1
    return counts.sum(axis=0)


@nb.njit
def influence():
    """Inward force on each tooth per unit of tight and of slack tension."""
    of_tight, of_slack, tension, pivot = np.empty(TEETH), np.empty(TEETH), np.empty(TEETH), np.empty(TEETH)
    mesh(1.0, 0.0, tension, pivot)
    for i in range(TEETH):
        of_tight[i] = inward(1.0, tension, i)
    mesh(0.0, 1.0, tension, pivot)
    for i in range(TEETH):
        of_slack[i] = inward(0.0, tension, i)
    return of_tight, of_slack


@nb.njit(parallel=True, fastmath=True)
def solved_once(speeds, tensions):
    force = centrifugal(speeds)
    of_tight, of_slack = influence()
    counts = np.zeros((len(tensions), TEETH + 2), np.int64)
    for t in nb.prange(len(tensions)):
        # The least inward force of the teeth so far; the ends are never passed (and not infinite, which fastmath excludes).
        held = np.empty(TEETH + 2)
        held[0], held[TEETH + 1] = 1e300, -1e300
        for i in range(TEETH):
            held[i + 1] = min(held[i], of_tight[i] * tensions[t] + of_slack[i] * SLACK)
        # The search starts where that of the previous speed ended, which is nearly always where this one ends too: five times as fast
        # as from the first tooth. It is correct for any order of the speeds, and fast if they are sorted.
        i, same, upper, lower = 0, 0, held[0], held[1]
        for s in range(len(force)):
            if lower < force[s] <= upper:
                same += 1
                continue
            counts[t, i + 1] += same
            while force[s] <= held[i + 1]:
                i += 1
            while force[s] > held[i]:
                i -= 1
            same, upper, lower = 1, held[i], held[i + 1]
        counts[t, i + 1] += same
    return counts.sum(axis=0)


@nb.njit(parallel=True, fastmath=True)
def by_crossing(speeds, tensions):
    force = np.sort(centrifugal(speeds))
    of_tight, of_slack = influence()
    counts = np.zeros((len(tensions), TEETH + 2), np.int64)
    for t in nb.prange(len(tensions)):
        least, held = 1e300, len(force)
        for i in range(TEETH):
            least = min(least, of_tight[i] * tensions[t] + of_slack[i] * SLACK)
            still = np.searchsorted(force, least, side="right")
            counts[t, i + 1] = held - still
            held = still
        counts[t, TEETH + 1] = held
    return counts.sum(axis=0)


if __name__ == "__main__":
    speeds, tensions = axes(int(sys.argv[1]) if len(sys.argv) > 1 else 10000)
    pairs, first = len(speeds) * len(tensions), None
    for run, repeats in ((per_pair, 1), (solved_once, 7), (by_crossing, 7)):
        run(*axes(8))  # compile before the clock starts
        times = []
        for _ in range(repeats):  # the quick ones are over before all cores are awake
            start = time.perf_counter()
            counts = run(speeds, tensions)
            times.append(time.perf_counter() - start)
        first = counts if first is None else first
        agrees = "as per_pair" if (counts == first).all() else "DIFFERS"
        print(f"{run.__name__:12s} {pairs} pairs  {pairs / min(times):.3e} pairs/s  {min(times):.4f} s  {agrees}")
    for tooth in range(1, TEETH + 2):
        print(f"  {'none lifts' if tooth > TEETH else f'tooth {tooth}':10s} {first[tooth]}")
