"""Drake's trajectories: polynomials in pieces, of Bernstein and of B-splines, quaternions, placements."""

from __future__ import annotations

from ...truth.geometry.curves import BREAKS, KNOTS, ORDER
from ..writing.source import Way, ways_of

_BEGIN = f"""t, breaks, x = 1.5 + 1.25 * v2[0] / (1 + abs(v2[0])), {list(BREAKS)}, np.array([v, a, tau, v2])
P, columns = drake.PiecewisePolynomial, np.array([v, a, tau, v2]).T
"""
_KNOTS = list(KNOTS)
_LOW, _HIGH = KNOTS[ORDER - 1], KNOTS[-ORDER]
_BASIS = f"basis = drake.BsplineBasis({ORDER}, {_KNOTS})\ncurve = drake.BsplineTrajectory(basis, list(x[:, :, None]))\n"
_SPAN = f"t = {_LOW} + {_HIGH - _LOW} * t / 3\n"
# Curve -> what makes it, in Drake's words.
_CURVES = {
    "held": ("ZeroOrderHold", "curve = P.ZeroOrderHold(breaks, columns)\n"),
    "straight": ("FirstOrderHold", "curve = P.FirstOrderHold(breaks, columns)\n"),
    "lagrange": ("LagrangeInterpolatingPolynomial", "curve = P.LagrangeInterpolatingPolynomial(breaks, columns)\n"),
    "hermite": ("CubicHermite", "curve = P.CubicHermite(breaks, columns, columns[:, ::-1])\n"),
    "of_end_speeds": (
        "CubicWithContinuousSecondDerivatives",
        "curve = P.CubicWithContinuousSecondDerivatives(breaks, columns, v2[:, None], v[:, None])\n",
    ),
    "without_knots": (
        "CubicWithContinuousSecondDerivatives",
        "curve = P.CubicWithContinuousSecondDerivatives(breaks, columns, False)\n",
    ),
    "bernstein": ("BezierCurve", "curve = drake.BezierCurve(breaks[0], breaks[-1], columns)\n"),
    "spline": ("BsplineTrajectory", f"{_BASIS}{_SPAN}"),
}
_VALUE = "value = curve.value(t).ravel()"
_SCALED = {"spline": (_HIGH - _LOW) / 3.0}
WAYS = {f"curve_{one}": Way(name, f"{_BEGIN}{code}{_VALUE}") for one, (name, code) in _CURVES.items()}
for _one, (_name, _code) in _CURVES.items():
    _factor = _SCALED.get(_one, 1.0)
    WAYS[f"curve_{_one}_rate"] = Way(
        f"{_name}, EvalDerivative", f"{_BEGIN}{_code}value = {_factor} * curve.EvalDerivative(t, 1).ravel()"
    )
    WAYS[f"curve_{_one}_rate:MakeDerivative"] = Way(
        f"{_name}, MakeDerivative", f"{_BEGIN}{_code}value = {_factor} * curve.MakeDerivative(1).value(t).ravel()"
    )
    if _one != "held":
        WAYS[f"curve_{_one}_second_rate"] = Way(
            f"{_name}, EvalDerivative", f"{_BEGIN}{_code}value = {_factor**2} * curve.EvalDerivative(t, 2).ravel()"
        )
_HERMITE, _STRAIGHT = _CURVES["hermite"][1], _CURVES["straight"][1]
_REST = "curve.AppendFirstOrderSegment(breaks[3], x[3])\n"
_QUATERNIONS = (
    "turns = [drake.Quaternion(q), drake.Quaternion(q2), drake.Quaternion(q).multiply(drake.Quaternion(q2))]\n"
    "t = min(t, breaks[2])\n"
)
_SLERP = f"{_BEGIN}{_QUATERNIONS}curve = drake.PiecewiseQuaternionSlerp(breaks[:3], turns)\n"
_POSES = (
    f"{_BEGIN}{_QUATERNIONS}poses = [drake.RigidTransform(one, p) for one, p in zip(turns, x)]\n"
    "curve = drake.PiecewisePose.MakeLinear(breaks[:3], poses)\n"
)
_FLAT = "value = [*X.translation(), *X.rotation().matrix().flat]"
WAYS |= ways_of(f"""
== curve_straight:AppendFirstOrderSegment | AppendFirstOrderSegment
{_BEGIN}curve = P.FirstOrderHold(breaks[:3], columns[:, :3])
{_REST}{_VALUE}
== curve_straight:ConcatenateInTime | ConcatenateInTime
{_BEGIN}curve = P.FirstOrderHold(breaks[:2], columns[:, :2])
curve.ConcatenateInTime(P.FirstOrderHold(breaks[1:], columns[:, 1:]))
{_VALUE}
== curve_straight:CompositeTrajectory | CompositeTrajectory
{_BEGIN}curve = drake.CompositeTrajectory([P.FirstOrderHold(breaks[:2], columns[:, :2]), P.FirstOrderHold(breaks[1:], \
columns[:, 1:])])
{_VALUE}
== curve_straight:StackedTrajectory | StackedTrajectory
{_BEGIN}curve = drake.StackedTrajectory()
for k in range(3): curve.Append(P.FirstOrderHold(breaks, columns[k : k + 1]))
{_VALUE}
== curve_straight:slice | slice | {_BEGIN}{_STRAIGHT}k = curve.get_segment_index(t)\ncurve = curve.slice(k, 1)\n{_VALUE}
== curve_hermite:shiftRight | shiftRight | {_BEGIN}{_HERMITE}curve.shiftRight(2.5)\nvalue = curve.value(t + 2.5)
== curve_hermite:ScaleTime | ScaleTime | {_BEGIN}{_HERMITE}curve.ScaleTime(0.5)\nvalue = curve.value(t / 2).ravel()
== curve_hermite:ReverseTime | ReverseTime | {_BEGIN}{_HERMITE}curve.ReverseTime()\nvalue = curve.value(-t).ravel()
== curve_hermite:Transpose | Transpose | {_BEGIN}{_HERMITE}curve = curve.Transpose()\n{_VALUE}
== curve_hermite:Block | Block, Reshape
{_BEGIN}{_HERMITE}value = np.r_[curve.Block(0, 0, 1, 1).value(t), curve.Block(1, 0, 2, 1).value(t)].ravel()
== curve_hermite:AppendCubicHermiteSegment | AppendCubicHermiteSegment
{_BEGIN}curve = P.CubicHermite(breaks[:3], columns[:, :3], columns[:, :0:-1])
curve.AppendCubicHermiteSegment(breaks[3], x[3], x[0])
{_VALUE}
== curve_hermite:getPolynomial | getPolynomial, Polynomial.EvaluateUnivariate
{_BEGIN}{_HERMITE}k = curve.get_segment_index(t)
value = [curve.getPolynomial(k, i).EvaluateUnivariate(t - breaks[k]) for i in range(3)]
== curve_hermite_rate:Polynomial.Derivative | Polynomial.Derivative
{_BEGIN}{_HERMITE}k = curve.get_segment_index(t)
value = [curve.getPolynomial(k, i).Derivative(1).EvaluateUnivariate(t - breaks[k]) for i in range(3)]
== curve_hermite_rate:DerivativeTrajectory | DerivativeTrajectory
{_BEGIN}{_HERMITE}curve = drake.DerivativeTrajectory(curve)
{_VALUE}
== curve_hermite_rate:TrajectorySource | TrajectorySource
{_BEGIN}{_HERMITE}source = drake.TrajectorySource(curve, 1)
c = source.CreateDefaultContext()
c.SetTime(t)
value = source.get_output_port().Eval(c)[3:]
== curve_hermite:FunctionHandleTrajectory | FunctionHandleTrajectory
{_BEGIN}{_HERMITE}of = curve
curve = drake.FunctionHandleTrajectory(lambda t: of.value(t), 3, 1, 0.0, 3.0)
{_VALUE}
== curve_bernstein:ElevateOrder | BezierCurve.ElevateOrder
{_BEGIN}{_CURVES["bernstein"][1]}curve.ElevateOrder()
{_VALUE}
== curve_bernstein:BernsteinBasis | BezierCurve.BernsteinBasis
{_BEGIN}{_CURVES["bernstein"][1]}value = sum(curve.BernsteinBasis(k, t) * x[k] for k in range(4))
== curve_bernstein:AsLinearInControlPoints | BezierCurve.AsLinearInControlPoints
{_BEGIN}{_CURVES["bernstein"][1]}z = t / breaks[-1]
weights = np.array([(1 - z)**3, 3 * z * (1 - z)**2, 3 * z**2 * (1 - z), z**3])
value = columns @ curve.AsLinearInControlPoints(0).toarray() @ weights
== curve_spline:EvaluateCurve | BsplineBasis.EvaluateCurve
{_BEGIN}{_CURVES["spline"][1]}value = basis.EvaluateCurve(list(x), t)
== curve_spline:EvaluateBasisFunctionI | BsplineBasis.EvaluateBasisFunctionI
{_BEGIN}{_CURVES["spline"][1]}value = sum(basis.EvaluateBasisFunctionI(k, t) * x[k] for k in range(4))
== curve_spline:EvaluateLinearInControlPoints | BsplineTrajectory.EvaluateLinearInControlPoints
{_BEGIN}{_CURVES["spline"][1]}value = columns @ curve.EvaluateLinearInControlPoints(t)
== curve_spline:InsertKnots | BsplineTrajectory.InsertKnots
{_BEGIN}{_CURVES["spline"][1]}curve.InsertKnots([0.5, 1.25])
{_VALUE}
== curve_backwards | ReverseTime, ScaleTime, shiftRight
{_BEGIN}{_HERMITE}curve.ReverseTime()
curve.shiftRight(breaks[-1])
curve.ScaleTime(2.0)
{_VALUE}
== curve_along_path | PathParameterizedTrajectory, EvalDerivative
{_BEGIN}{_HERMITE}end = breaks[-1]
path = drake.PiecewisePolynomial.LagrangeInterpolatingPolynomial([0.0, end / 2, end], np.array([[0.0, end / 4, end]]))
value = drake.PathParameterizedTrajectory(curve, path).EvalDerivative(t, 1).ravel()
== curve_growing | ExponentialPlusPiecewisePolynomial
{_BEGIN}{_STRAIGHT}alpha = np.stack([v * np.exp(s / 4) for s in breaks[:-1]], axis=1)
curve = drake.ExponentialPlusPiecewisePolynomial(np.eye(3), np.eye(3) / 4, alpha, curve)
{_VALUE}
== turns_between | PiecewiseQuaternionSlerp | {_SLERP}value = curve.orientation(t).rotation().ravel()
== turns_between:PiecewisePose | PiecewisePose.get_orientation_trajectory
{_POSES}value = curve.get_orientation_trajectory().orientation(t).rotation().ravel()
== turns_between:Append | PiecewiseQuaternionSlerp.Append
{_BEGIN}{_QUATERNIONS}curve = drake.PiecewiseQuaternionSlerp(breaks[:2], turns[:2])
curve.Append(breaks[2], turns[2])
value = curve.orientation(t).rotation().ravel()
== turning_between | PiecewiseQuaternionSlerp.angular_velocity | {_SLERP}value = curve.angular_velocity(t)
== pose_between | PiecewisePose.GetPose | {_POSES}X = curve.GetPose(t)\n{_FLAT}
== twist_between | PiecewisePose.GetVelocity | {_POSES}value = np.roll(curve.GetVelocity(t), 3)
""")
