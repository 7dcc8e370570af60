#!/usr/bin/env python3
"""Writes golden.csv beside itself: numbers of SciPy against which tests/probability compares. Needs scipy (written with 1.17.1)."""
import csv
import pathlib

import numpy as np
import scipy
from scipy import integrate, stats

# As a test knows it, as SciPy does, and the range that is kept, if it is truncated.
SHAPES = [
    ("uniform -2 3", stats.uniform(-2, 5), None),
    ("normal 0.08 0.006", stats.norm(0.08, 0.006), None),
    ("lognormal 570 80", None, None),
    ("lognormal 1 3", None, None),
    ("triangular 0.85 0.9 1.15", stats.triang(0.05 / 0.3, 0.85, 0.3), None),
    ("triangular 1 1 2", stats.triang(0, 1, 1), None),
    ("beta 2 3.5 10 20", stats.beta(2, 3.5, 10, 10), None),
    ("beta 0.4 0.7 0 1", stats.beta(0.4, 0.7), None),
    ("beta 800 1200 0 1", stats.beta(800, 1200), None),
    ("weibull 1.7 30 5", stats.weibull_min(1.7, 5, 30), None),
    ("weibull 0.6 2 0", stats.weibull_min(0.6, 0, 2), None),
    ("gumbel 150 12", stats.gumbel_r(150, 12), None),
    ("exponential 0.25", stats.expon(0, 0.25), None),
    ("normal 0.08 0.006", stats.norm(0.08, 0.006), (0.07, 0.085)),
    ("normal 0 1", stats.norm(0, 1), (4, 5)),
    ("normal 0 1", stats.norm(0, 1), (-5, -4)),
    ("triangular 0.85 0.9 1.15", stats.triang(0.05 / 0.3, 0.85, 0.3), (0.87, 1.0)),
    ("beta 2 3.5 10 20", stats.beta(2, 3.5, 10, 10), (12, 14)),
    ("weibull 1.7 30 5", stats.weibull_min(1.7, 5, 30), (10, 60)),
    ("gumbel 150 12", stats.gumbel_r(150, 12), (140, 190)),
    ("exponential 0.25", stats.expon(0, 0.25), (0.1, 1)),
]
PLACES = [1e-12, 1e-6, 0.001, 0.025, 0.3, 0.5, 0.8, 0.975, 0.999, 1 - 2.0**-20]


def lognormal(mean, sd):
    variance = np.log1p((sd / mean) ** 2)
    return stats.lognorm(np.sqrt(variance), scale=mean * np.exp(-variance / 2))


def quantile(law, cut, p):
    if cut is None:
        return law.ppf(p)
    if cut[0] >= law.median():
        return law.isf(law.sf(cut[0]) - p * (law.sf(cut[0]) - law.sf(cut[1])))
    return law.ppf(law.cdf(cut[0]) + p * (law.cdf(cut[1]) - law.cdf(cut[0])))


def moments(law, cut):
    if cut is None:
        return law.mean(), law.std()
    # The density is scaled before it is integrated, so that a far tail is as good as the middle.
    middle = law.pdf((cut[0] + cut[1]) / 2)
    kink = [0.9] if cut == (0.87, 1.0) else None
    over = lambda f: integrate.quad(lambda x: f(x) * law.pdf(x) / middle, *cut, epsabs=0, epsrel=1e-13, limit=500, points=kink)[0]
    kept = over(lambda x: 1)
    mean = over(lambda x: x) / kept
    return mean, np.sqrt(over(lambda x: (x - mean) ** 2) / kept)


def main():
    with open(pathlib.Path(__file__).with_name("golden.csv"), "w", newline="") as file:
        file.write(f"# tests/probability/golden.py with scipy {scipy.__version__}\n")
        out = csv.writer(file, lineterminator="\n")
        number = lambda value: repr(float(value))
        for name, law, cut in SHAPES:
            law = law or lognormal(*map(float, name.split()[1:]))
            ends = [number(end) for end in cut] if cut else ["", ""]
            mean, sd = moments(law, cut)
            out.writerow(["moments", name, *ends, number(mean), number(sd)])
            for p in PLACES:
                out.writerow(["quantile", name, *ends, number(p), number(quantile(law, cut, p))])
        for draws, holds in [(1, 0), (1, 1), (10, 3), (4096, 4096), (4096, 4095), (4096, 4090), (1000000, 0), (1000000, 3), (1000000, 999000),
                             (1000000, 999999), (1000000, 500000), (10**8, 99990000)]:
            for confidence in [0.95, 0.99, 1 - 0.01 / 1827]:
                half = (1 - confidence) / 2
                low = 0 if holds == 0 else stats.beta.ppf(half, holds, draws - holds + 1)
                missed = 0 if holds == draws else stats.beta.ppf(half, draws - holds, holds + 1)
                out.writerow(["interval", holds, draws, number(confidence), number(low), number(missed)])


if __name__ == "__main__":
    main()
