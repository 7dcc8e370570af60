"""A variator in OpenMDAO: a component whose values and differences come from one call of `beltspace.evaluate`. Needs OpenMDAO."""

import os

# No reports in the current folder.
os.environ.setdefault("OPENMDAO_REPORTS", "0")

import numpy as np
import openmdao.api as om

import beltspace

INPUTS = {"band_thickness_mm": 0.2, "groove_angle_deg": 22.0}
OUTPUTS = ["axial_force_N", "stress_margin"]
FIXED = {"torque_Nm": 150.0, "band_count": 9}


class Variator(om.ExplicitComponent):  # type: ignore[misc]
    """The push belt: units stand in the names, so that OpenMDAO need not convert."""

    def setup(self) -> None:
        for name, value in INPUTS.items():
            self.add_input(name, value)
        for name in OUTPUTS:
            self.add_output(name)
        self.declare_partials("*", "*")

    def evaluated(self, inputs: om.DefaultVector, steps: np.ndarray) -> dict[str, np.ndarray]:
        """The outputs at the inputs, each of which is stepped in rows of its own."""
        rows = {name: inputs[name][0] * (1 + steps[at]) for at, name in enumerate(INPUTS)}
        found = beltspace.evaluate("metal-cvt", rows | FIXED, outputs=OUTPUTS)
        if any(status != "ok" for status in found["status"]):
            raise om.AnalysisError(f"no drive at {dict(inputs)}: {found['status'][0]}")
        return {name: found[name] for name in OUTPUTS}

    def compute(self, inputs: om.DefaultVector, outputs: om.DefaultVector) -> None:
        for name, values in self.evaluated(inputs, np.zeros((len(INPUTS), 1))).items():
            outputs[name] = values[0]

    def compute_partials(self, inputs: om.DefaultVector, partials: om.DefaultVector) -> None:
        # Central differences, all in one call: rows of steps up, then down.
        step = 1e-5
        found = self.evaluated(inputs, np.hstack([step * np.eye(len(INPUTS)), -step * np.eye(len(INPUTS))]))
        for output, values in found.items():
            up, down = np.split(values, 2)
            for at, name in enumerate(INPUTS):
                partials[output, name] = (up[at] - down[at]) / (2 * step * inputs[name][0])


problem = om.Problem(reports=False)
problem.model.add_subsystem("variator", Variator(), promotes=["*"])
problem.model.add_design_var("band_thickness_mm", lower=0.1, upper=0.4)
problem.model.add_design_var("groove_angle_deg", lower=18, upper=30)
problem.model.add_constraint("stress_margin", lower=0.3)
problem.model.add_objective("axial_force_N", ref=1e4)
problem.driver = om.ScipyOptimizeDriver(optimizer="SLSQP", disp=False)
problem.setup()
problem.run_driver()
for name in [*INPUTS, *OUTPUTS]:
    print(f"{name} = {problem.get_val(name)[0]:.5g}")
