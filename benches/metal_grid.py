#!/usr/bin/env python3
"""The metal-belt grid study as a drive engineer would write it without beltspace: numpy (or numba) plus moocore for the front.

Same work as studies/metal-grid.toml: every combination of friction, groove angle, ratio, band thickness and band count; traction at
the slip limit; per design the torque capacity and the larger axial force at that capacity; feasible when the force is at
most 30 kN and the capacity positive; front of (max torque capacity, min axial force).

    pip install numpy numba moocore
    python metal_grid.py [levels]      # levels per continuous axis, default 37 (20 615 771 designs)
"""
import sys
import time

import moocore
import numba as nb
import numpy as np

WIDTH, MODULUS, STRENGTH, CENTRE, LENGTH, LIMIT = 9.0, 2.1e5, 500.0, 156.0, 613.0, 30e3
FREE = LENGTH / (2 * np.pi)


def geometry(ratio):
    lo, hi = np.full_like(ratio, 1e-6), np.minimum(CENTRE / np.maximum(np.abs(ratio - 1), 1e-9) * 0.999999, LENGTH)
    for _ in range(200):
        r = 0.5 * (lo + hi)
        d = (ratio - 1) * r
        g = np.arcsin(d / CENTRE)
        long = 2 * CENTRE * np.cos(g) + np.pi * (1 + ratio) * r + 2 * g * d > LENGTH
        lo, hi = np.where(long, lo, r), np.where(long, r, hi)
    g = np.arcsin((ratio - 1) * r / CENTRE)
    return r, ratio * r, np.pi - 2 * g, np.pi + 2 * g


def axes(k):
    return (np.linspace(.06, .12, k), np.radians(np.linspace(18, 30, k)), np.linspace(.5, 2, k), np.linspace(.1, .4, k), np.arange(4., 15.))


def designs(mu, a, r1, r2, w1, w2, h, n):
    """torque capacity (N mm) and the larger axial force (N), broadcast over the arguments."""
    s, t, c = np.sin(a / 2), np.tan(a / 2), np.cos(a / 2)
    lam = np.tanh(mu / s * np.minimum(w1, w2) / 2)  # whichever pulley slips first
    stress = np.maximum(0., STRENGTH - MODULUS * h / 2 * (1 / np.minimum(r1, r2) - 1 / FREE))
    P = stress * 2 * n * WIDTH * h * 2 * lam / (1 + lam)
    k = (1 - mu * t) / (mu + t)
    driver = (1 + lam) / (4 * lam) * w1 * k * P
    arc = np.log((1 + lam) / (1 - lam)) * s / mu
    driven = ((1 - lam) / (4 * lam) * (w2 - arc) * k + c / (2 * mu)) * P
    return P * r1, np.maximum(driver, driven)


def front(cap, force):
    points = np.column_stack([-cap, force])
    return points[moocore.is_nondominated(points)]


def with_numpy(ax):
    mu, a, ratio, h, n = ax
    geo, best, count = geometry(ratio), [], 0
    for m in mu:  # a slab at a time: what fits in memory
        aa, i, hh, nn = np.meshgrid(a, np.arange(len(ratio)), h, n, indexing="ij", sparse=True)
        cap, force = designs(m, aa, *(g[i] for g in geo), hh, nn)
        ok = (force <= LIMIT) & (cap > 0)
        count += int(ok.sum())
        if ok.any():
            best.append(front(cap[ok], force[ok]))
    best = np.concatenate(best)
    return count, best[moocore.is_nondominated(best)]


@nb.njit(parallel=True, fastmath=True, cache=True)
def _slab(mu, a, r1, r2, w1, w2, h, n, cap, force):
    total = 0
    for q in nb.prange(len(a)):
        s, t, c = np.sin(a[q] / 2), np.tan(a[q] / 2), np.cos(a[q] / 2)
        k = (1 - mu * t) / (mu + t)
        got = 0
        for i in range(len(r1)):
            lam = np.tanh(mu / s * min(w1[i], w2[i]) / 2)
            arc = np.log((1 + lam) / (1 - lam)) * s / mu
            f = max((1 + lam) / (4 * lam) * w1[i] * k, (1 - lam) / (4 * lam) * (w2[i] - arc) * k + c / (2 * mu))
            bend = MODULUS / 2 * (1 / min(r1[i], r2[i]) - 1 / FREE)
            for j in range(len(h)):
                p = max(0., STRENGTH - bend * h[j]) * 2 * WIDTH * h[j] * 2 * lam / (1 + lam)
                for m in range(len(n)):
                    P = p * n[m]
                    ok = P * f <= LIMIT and P > 0
                    at = ((q * len(r1) + i) * len(h) + j) * len(n) + m
                    cap[at] = P * r1[i] if ok else 0.
                    force[at] = P * f
                    got += ok
        total += got
    return total


def with_numba(ax):
    mu, a, ratio, h, n = ax
    geo, best, count = geometry(ratio), [], 0
    cap = np.empty(len(a) * len(ratio) * len(h) * len(n))
    force = np.empty_like(cap)
    for m in mu:
        count += int(_slab(m, a, *geo, h, n, cap, force))
        ok = cap > 0
        if ok.any():
            best.append(front(cap[ok], force[ok]))
    best = np.concatenate(best)
    return count, best[moocore.is_nondominated(best)]


@nb.njit(parallel=True, fastmath=True, cache=True)
def _rows(mu, a, r1, r2, w1, w2, h, n, ceiling, coarse, start, cap, force, survivors):
    """One friction: counts feasible designs, and per row (angle, ratio) those that `ceiling` does not rule out. ceiling[b] is the
    largest capacity known at a force below bin b, `coarse` the same of fewer bins. With `start`, writes the survivors of each row
    from there instead."""
    total = 0
    per_force = len(ceiling) / LIMIT
    writes = len(start) > 0
    for q in nb.prange(len(a)):
        s, t, c = np.sin(a[q] / 2), np.tan(a[q] / 2), np.cos(a[q] / 2)
        k = (1 - mu * t) / (mu + t)
        got = 0
        for i in range(len(r1)):
            if writes and survivors[q, i] == 0:
                continue
            lam = np.tanh(mu / s * min(w1[i], w2[i]) / 2)
            arc = np.log((1 + lam) / (1 - lam)) * s / mu
            f = max((1 + lam) / (4 * lam) * w1[i] * k, (1 - lam) / (4 * lam) * (w2[i] - arc) * k + c / (2 * mu))
            bend = MODULUS / 2 * (1 / min(r1[i], r2[i]) - 1 / FREE)
            # The designs of a row differ in P alone, so that capacity is force times r1 / f: is that line above the table anywhere?
            above = False
            for b in range(len(coarse)):
                above |= (b + 1) * (LIMIT / len(coarse)) * (r1[i] / f) > coarse[b]
            kept = 0
            for j in range(len(h)):
                p = max(0., STRENGTH - bend * h[j]) * 2 * WIDTH * h[j] * 2 * lam / (1 + lam)
                for m in range(len(n)):
                    P = p * n[m]
                    got += P * f <= LIMIT and P > 0
                if not above:
                    continue
                for m in range(len(n)):
                    P = p * n[m]
                    if P * f <= LIMIT and P > 0 and P * r1[i] > ceiling[min(int(P * f * per_force), len(ceiling) - 1)]:
                        if writes:
                            cap[start[q, i] + kept] = P * r1[i]
                            force[start[q, i] + kept] = P * f
                        kept += 1
            survivors[q, i] = kept
        total += got
    return total


def _ceiling(points, bins):
    """Largest capacity at a force below each of the bins. A point counts from the bin after its own, and with a little less than its value:
    a design must not rule itself out if another loop computes it with another last bit."""
    found = np.zeros(bins + 1)
    np.maximum.at(found, np.minimum((points[:, 1] * (bins / LIMIT)).astype(int) + 1, bins), -points[:, 0] * (1 - 1e-12))
    return np.maximum.accumulate(found)[:bins]


def with_numba_filtered(ax):
    """As `with_numba`, but written for 1e12 designs: only designs that pass a table of the best capacity per force are stored, so that
    memory does not grow with the grid and moocore gets only a small fraction of it."""
    mu, a, ratio, h, n = ax
    geo, none, nowhere = geometry(ratio), np.empty(0), np.empty((0, 0), dtype=np.int64)
    # A few levels of each axis, ends too, are designs of the grid: their front rules out most of the rest from the start.
    some = [np.unique(np.r_[x[::max(1, len(x) // 24)], x[-1]]) for x in (mu, a, ratio, h)]
    known, best, count = with_numba((*some, n))[1], np.empty((0, 2)), 0
    survivors = np.empty((len(a), len(ratio)), dtype=np.int64)
    for m in mu:
        ceiling, coarse = (_ceiling(np.concatenate([known, best]), bins) for bins in (1 << 14, 1 << 8))
        count += int(_rows(m, a, *geo, h, n, ceiling, coarse, nowhere, none, none, survivors))
        ends = np.cumsum(survivors).reshape(survivors.shape)
        cap, force = np.empty(ends[-1, -1]), np.empty(ends[-1, -1])
        _rows(m, a, *geo, h, n, ceiling, coarse, ends - survivors, cap, force, survivors)
        best = np.concatenate([best, np.column_stack([-cap, force])])
        best = best[moocore.is_nondominated(best)]
    return count, best


if __name__ == "__main__":
    ax = axes(int(sys.argv[1]) if len(sys.argv) > 1 else 37)
    total = int(np.prod([float(len(a)) for a in ax]))
    with_numba_filtered(axes(6))  # compile before the clock starts
    for name, run in (("numpy + moocore", with_numpy), ("numba (all cores) + moocore", with_numba), ("numba, filtered + moocore", with_numba_filtered)):
        start = time.perf_counter()
        count, best = run(ax)
        seconds = time.perf_counter() - start
        print(f"{name:28s} {total} designs  {total / seconds:.3e} designs/s  {seconds:.2f} s  feasible {count}  front {len(best)}")
