"""Derivatives of dynamics by Drake's automatic differentiation."""

from __future__ import annotations

from ...interface import STEP
from ..writing.source import Way
from .drake_forces import QV


def gradient(result: str, seeds: str) -> str:
    """Derivatives by Drake's automatic differentiation."""
    return f"""from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, InitializeAutoDiff
ad = p.ToAutoDiffXd()
d = ad.CreateDefaultContext()
d.SetTimeStateAndParametersFrom(c)
{QV}N = np.stack([p.MapVelocityToQDot(c, one) for one in np.eye(len(v))], axis=1)
{seeds}
ad.SetPositions(d, q_)
ad.SetVelocities(d, v_)
{result}
value = ExtractGradient(out)"""


BY_Q = "q_ = InitializeAutoDiff(q, N).flatten()\nv_ = InitializeAutoDiff(v, np.zeros((len(v), len(v)))).flatten()"
BY_V = "q_ = InitializeAutoDiff(q, 0 * N).flatten()\nv_ = InitializeAutoDiff(v, np.eye(len(v))).flatten()"
_INVERSE = """from pydrake.multibody.tree import MultibodyForces_
applied = MultibodyForces_[AutoDiffXd](ad)
ad.CalcForceElementsContribution(d, applied)
out = ad.CalcInverseDynamics(d, InitializeAutoDiff(a, np.zeros((len(v), len(v)))).flatten(), applied)"""
_FORWARD = """port = ad.get_applied_generalized_force_input_port()
port.FixValue(d, InitializeAutoDiff(tau, np.zeros((len(v), len(v)))).flatten())
out = ad.EvalTimeDerivatives(d).CopyToVector()[len(q):]"""
# Entries that depend on nothing have no derivatives.
EACH = """
many = np.array(out, dtype=object)
out = np.r_[many.ravel(), InitializeAutoDiff(v * 0, np.eye(len(v))).flatten()]"""
WHOLE = "\nvalue = value[: many.size].reshape(*many.shape, -1)"
_POSES = """poses = [ad.EvalBodyPoseInWorld(d, ad.get_body(b.index())) for b in links]
out = [[*x.translation(), *x.rotation().matrix().flat] for x in poses]"""
WAYS = {
    "mass_matrix_dq": Way("CalcMassMatrix, AutoDiffXd", gradient(f"out = ad.CalcMassMatrix(d){EACH}", BY_Q) + WHOLE),
    "link_poses_dq": Way("EvalBodyPoseInWorld, AutoDiffXd", gradient(_POSES + EACH, BY_Q) + WHOLE),
    "inverse_dynamics_dq": Way("CalcInverseDynamics, AutoDiffXd", gradient(_INVERSE, BY_Q)),
    "inverse_dynamics_dv": Way("CalcInverseDynamics, AutoDiffXd", gradient(_INVERSE, BY_V)),
    "forward_dynamics_dq": Way("EvalTimeDerivatives, AutoDiffXd", gradient(_FORWARD, BY_Q)),
    "forward_dynamics_dv": Way("EvalTimeDerivatives, AutoDiffXd", gradient(_FORWARD, BY_V)),
    "gravity_dq": Way(
        "CalcGravityGeneralizedForces, AutoDiffXd",
        gradient("out = -ad.CalcGravityGeneralizedForces(d)", BY_Q),
    ),
}
# Where a discrete plant's step leads: coordinates along the speeds that they begin and end at.
_DISCRETE = (
    ("Plant(0.0)", f"Plant({STEP})"),
    ("p.Finalize()", "p.SetUseSampledOutputPorts(False)\np.Finalize()"),
)
_LINEAR = f"""{QV}port = p.get_applied_generalized_force_input_port()
port.FixValue(c, tau)
linear = drake.FirstOrderTaylorApproximation(p, c, port.get_index(), drake.OutputPortSelection.kNoOutput)
end, n = p.CreateDefaultContext(), len(v)
p.SetPositionsAndVelocities(end, p.EvalUniquePeriodicDiscreteUpdate(c).value())
def along_speeds(X): return np.vstack([np.stack([p.MapQDotToVelocity(end, x) for x in X[:-n].T], axis=1), X[-n:]])
N = np.stack([p.MapVelocityToQDot(c, one) for one in np.eye(n)], axis=1)
"""
for _step in ("dampers_implicit_straight", "stiffness_implicit_straight"):
    WAYS[f"step_{_step}_derivative"] = Way(
        "FirstOrderTaylorApproximation: A",
        f"{_LINEAR}A = linear.A()\nvalue = along_speeds(np.hstack([A[:, :-n] @ N, A[:, -n:]]))",
        built=_DISCRETE,
    )
    WAYS[f"step_{_step}_force_derivative"] = Way(
        "FirstOrderTaylorApproximation: B", f"{_LINEAR}value = along_speeds(linear.B())", built=_DISCRETE
    )
# Other scalars that carry the same numbers.
_SCALARS = {"ToAutoDiffXd": "x.value()", "ToSymbolic": "x.Evaluate()"}
_OF_SCALARS = {
    "mass_matrix": "[*map(list, ad.CalcMassMatrix(d))]",
    "coriolis_forces": "[ad.CalcBiasTerm(d)]",
    "gravity": "[-ad.CalcGravityGeneralizedForces(d)]",
    "link_poses": "[[*x.translation(), *x.rotation().matrix().flat] for x in"
    " (ad.EvalBodyPoseInWorld(d, ad.get_body(b.index())) for b in links)]",
}


def _by_scalar(name: str, of: str) -> Way:
    kind = "AutoDiffXd" if name == "ToAutoDiffXd" else "Expression"
    read = f"value = [[{_SCALARS[name]} if hasattr(x, '{_SCALARS[name][2:-2]}') else x for x in row] for row in {of}]"
    flat = "" if of.startswith("[[*x") or of.startswith("[*map") else "\nvalue = value[0]"
    return Way(
        f"{name}, {of.partition('ad.')[2].partition('(')[0]} of {kind}",
        f"{QV}ad = p.{name}()\nd = ad.CreateDefaultContext()\nd.SetTimeStateAndParametersFrom(c)\n{read}{flat}",
    )


WAYS |= {f"{one}:{name}": _by_scalar(name, of) for name in _SCALARS for one, of in _OF_SCALARS.items()}
