"""The formulas of metal-cvt in numpy, as the paper has them, for belts that are squeezed just enough not to slip (traction = "limit").

Written as an engineer would who needs speed: whole arrays, each number computed once, only what the outputs that are asked for need. The
checks are those of the model: a belt that is too short or fits no pulleys, pulleys that overlap, friction beyond the wedge. Each takes the
outputs away that have no meaning then, and is the status; so does a number that f64 cannot hold.
"""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]
WIDTH, MODULUS, STRENGTH, CENTRE, LENGTH, TORQUE = 9e-3, 2.1e11, 500e6, 0.156, 0.613, 100.0
FREE = LENGTH / (2 * np.pi)
STATUSES = ["ok", "overflow", "belt too short", "no geometry", "pulleys overlap", "friction beyond the wedge"]
# Outputs in units other than those of SI: what one unit is.
UNITS = {"N_per_mm": 1e3, "mm": 1e-3, "deg": np.pi / 180, "MPa": 1e6, "kW": 1e3}
# What friction beyond the wedge takes away.
AXIAL = {
    "driver_axial_coefficient", "driven_axial_coefficient", "driver_axial_force_N", "driven_axial_force_N", "axial_force_N", "thrust_ratio",
    "capacity_axial_force_N", "clamping_safety", "clamping_utilisation",
}  # fmt: skip


def driver_radius(ratio: Column) -> Column:
    """Pitch radius of the driver in m, by Newton's steps from above, as many as f64 needs (ratios from 0.2 to 5)."""
    radius = (LENGTH - 2 * CENTRE) / (np.pi * (1 + ratio))
    step, both = ratio - 1, np.pi * (1 + ratio)
    for _ in range(4):
        sine = step * radius / CENTRE
        lean = np.arcsin(sine)
        slope = both + 2 * lean * step
        radius = radius - (2 * CENTRE * np.sqrt(1 - sine * sine) + slope * radius - LENGTH) / slope
    return radius


def evaluate(rows: dict[str, Column], asked: Iterable[str] | None = None) -> dict[str, np.ndarray]:
    """Outputs by name, all if none are asked for, and `status`."""
    mu, angle, ratio = rows["friction"], np.radians(rows["groove_angle_deg"]), rows["ratio"]
    thickness, sections = rows["band_thickness_mm"] * 1e-3, 2 * rows["band_count"]
    wanted = None if asked is None else set(asked)

    def want(*names: str) -> bool:
        return wanted is None or any(name in wanted for name in names)

    out: dict[str, np.ndarray] = {}
    with np.errstate(all="ignore"):
        r1 = driver_radius(ratio)
        r2 = ratio * r1
        lean = np.arcsin((r2 - r1) / CENTRE)
        w1, w2 = np.pi - 2 * lean, np.pi + 2 * lean
        sine, cosine = np.sin(angle / 2), np.cos(angle / 2)
        friction = mu / sine
        wedge_margin = cosine - mu * sine
        wedge = wedge_margin / (mu * cosine + sine)
        pull = np.expm1(friction * w2)
        driven_limit = pull / (pull + 2)
        other = np.expm1(friction * w1)
        driver_limit = other / (other + 2)
        limit = np.minimum(driven_limit, driver_limit)
        arc = np.minimum(w1, w2)
        driver = (1 + limit) / 4 * w1 * wedge
        active = limit / (2 * mu) * cosine
        slack = (1 - limit) / 4 * (w2 - arc)
        driven = slack * wedge + active
        small = np.minimum(r1, r2)
        area = sections * WIDTH * thickness
        bending = MODULUS * thickness / 2 * (1 / small - 1 / FREE)
        if want("torque_capacity_Nm", "capacity_axial_force_N"):
            tight = np.maximum((STRENGTH - bending) * area, 0)
            share = 2 / (1 + limit)
            out["torque_capacity_Nm"] = tight * (share * limit * r1)
            out["capacity_axial_force_N"] = tight * (share * np.maximum(driver, driven))
        if wanted is None:
            unsupported = cosine / sine
            belt = TORQUE / r1
            total = belt / limit
            free = FREE / (FREE - small)
            speed = np.zeros_like(r1)
            tensile = total * (1 + limit) / 2 / area
            upper = [total * (1 + limit) / 4 * w1 * unsupported, total * (slack * unsupported + active)]
            out |= {
                "driver_radius_mm": r1, "driven_radius_mm": r2, "driver_wrap_deg": w1, "driven_wrap_deg": w2,
                "effective_friction": friction, "traction_limit": limit, "driven_traction_limit": driven_limit,
                "driver_traction_limit": driver_limit, "traction_used": limit.copy(), "slip_margin": np.zeros_like(r1),
                "active_arc_deg": arc, "driver_axial_coefficient": driver, "driven_axial_coefficient": driven, "belt_force_N": belt,
                "tight_force_N": total * (1 + limit) / 2, "slack_force_N": total * (1 - limit) / 2,
                "driver_axial_force_N": driver * total, "driven_axial_force_N": driven * total,
                "axial_force_N": np.maximum(driver, driven) * total, "driver_axial_force_upper_N": upper[0],
                "driven_axial_force_upper_N": upper[1], "axial_force_upper_N": np.maximum(*upper), "clamping_safety": driven / active,
                "clamping_utilisation": active / driven, "thrust_ratio": driver / driven, "belt_speed_m_per_s": speed,
                "centrifugal_force_N": speed.copy(), "power_kW": speed.copy(), "tensile_stress_MPa": tensile, "bending_stress_MPa": bending,
                "max_stress_MPa": tensile + bending, "stress_margin": 1 - (tensile + bending) / STRENGTH,
                "optimum_thickness_mm": STRENGTH / MODULUS * small * free,
                "torque_coefficient_N_per_mm": limit / (1 + limit) * STRENGTH**2 / MODULUS * free * sections * WIDTH,
                "printed_torque_coefficient_N_per_mm": (1 - limit) / (1 + limit) * pull * STRENGTH**2 / MODULUS * free * sections * WIDTH / 2,
                "entry_compression": (limit - driven_limit) * (pull + 2) / (2 * limit),
            }  # fmt: skip
        # Which checks fail, the first one last.
        status = np.zeros(len(r1), np.uint16)
        no_axial = ~(wedge_margin > 0)
        status[no_axial] = 5
        overlap = ~(CENTRE - r1 - r2 > 0)
        none = ~(2 * np.pi * CENTRE * np.maximum(ratio, 1) - LENGTH * np.abs(ratio - 1) > 0)
        status[overlap] = 4
        status[none] = 3
        gone = overlap | none
        for name, column in out.items():
            unit = next((it for suffix, it in UNITS.items() if name.endswith("_" + suffix)), None)
            if unit is not None:
                out[name] = column = column / unit
            absent = gone if name not in ("power_kW", "effective_friction") else np.zeros_like(gone)
            if name in AXIAL:
                absent = absent | no_axial
            overflown = ~np.isfinite(column) & ~absent
            if overflown.any():
                status[overflown & (status == 0)] = 1
            column[absent | overflown] = np.nan
        out["status"] = status
    return out
