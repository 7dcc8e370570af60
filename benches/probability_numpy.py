"""Yields of push belts as an engineer would count them with numpy: for every design and draw the equations of the belt, in blocks of designs
by draws, so that what is between two operations stays in the processor's cache.

Equation numbers are those of the paper that the model follows, see `beltspace models metal-cvt`.
"""
import numpy as np

LENGTH, CENTRE, MODULUS = 613.0, 156.0, 2.1e5
# Designs in a block: of 4, 8, 16, 32, 64 and 128 this is the fastest with 4096 draws.
BLOCK = 16


def geometry(ratio):
    """Pitch radius of the driver, and the wrap angles of driver and driven pulley: the radius at which the belt has its length."""
    low, high = 0.0, (LENGTH - 2 * CENTRE) / (np.pi * (1 + ratio)) * 1.1
    for _ in range(200):
        radius = 0.5 * (low + high)
        step = (ratio - 1) * radius
        lean = np.arcsin(step / CENTRE)
        is_long = 2 * CENTRE * np.cos(lean) + np.pi * (1 + ratio) * radius + 2 * lean * step > LENGTH
        low, high = (low, radius) if is_long else (radius, high)
    return radius, np.pi - 2 * lean, np.pi + 2 * lean


def grip(friction, angle, traction, wraps):
    """Does the belt not slip, and the larger axial force over the sum of the belt forces; (2), (4)-(6), (12), (15), (16)."""
    sine, cosine = np.sin(angle / 2), np.cos(angle / 2)
    along = friction / sine
    limit = np.tanh(along * (min(wraps) / 2))
    wedge = (cosine - friction * sine) / (friction * cosine + sine)
    arc = np.minimum(np.log((1 + traction) / (1 - traction)) / along, wraps[1])
    driver = (1 + traction) / 4 * wraps[0] * wedge
    driven = (1 - traction) / 4 * (wraps[1] - arc) * wedge + traction / (2 * friction) * cosine
    return traction <= limit, np.maximum(driver, driven)


def holds(designs, draws, study, is_hoisted):
    """Which draws (columns) of which designs (rows) hold in every operating case. Hoisted: the designs have one groove angle, and what hangs on
    friction and angle alone is computed once for all of them."""
    angle, thickness, bands, width = (column[:, None] for column in designs.T)
    friction, factor, strength = (column[None, :] for column in draws)
    if is_hoisted:
        angle = angle[:1]
    area = 2 * bands * width * thickness
    kept = np.ones((len(designs), friction.shape[1]), bool)
    traction = study["traction"]
    for ratio, torque in study["cases"]:
        radius, *wraps = geometry(ratio)
        does_grip, coefficient = grip(friction, angle, traction, wraps)
        belt_forces = torque * 1e3 * factor / radius / traction  # (3), (14)
        bending = MODULUS * thickness / 2 * (1 / min(radius, ratio * radius) - 2 * np.pi / LENGTH)  # (18)
        stress = belt_forces * ((1 + traction) / 2) / area + bending  # (17), (22)
        kept &= does_grip & (coefficient * belt_forces <= study["axial_force_N"]) & (1 - stress / strength >= 0)
    return kept


def counts(designs, draws, study, is_hoisted=False):
    """How many draws of each design hold."""
    found = np.empty(len(designs), np.int64)
    # Blocks of one angle each, for both ways the same.
    edges = np.flatnonzero(np.diff(designs[:, 0])) + 1
    for part in np.split(np.arange(len(designs)), edges):
        for start in range(0, len(part), BLOCK):
            block = part[start:start + BLOCK]
            found[block] = np.count_nonzero(holds(designs[block], draws, study, is_hoisted), axis=1)
    return found
