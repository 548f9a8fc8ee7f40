"""Text of the calls about spacecraft: a hub with effectors, as functions of a state."""

# `hub`: mass, mass centre, inertia. `chains`: kind of joint, bodies: R, p, axis, mass, mass centre, inertia, stiffness,
# damping, coordinate at rest. Coordinates: position, quaternion, joints; speeds: linear before, angular after, joints.
CRAFT = """def column(x): return np.reshape(x, (-1, 1)).tolist()
def mrp(e): return np.array(e[1:]) * (1 if e[0] >= 0 else -1) / (1 + abs(e[0]))
def turned(s):
    n, K = s @ s, np.array([[0, -s[2], s[1]], [s[2], 0, -s[0]], [-s[1], s[0], 0]])
    return np.eye(3) + (8 * K @ K + 4 * (1 - n) * K) / (1 + n)**2
def about(u, angle):
    K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
def message(name, **fields):
    payload = getattr(messaging, name + 'Payload')()
    for field, value in fields.items(): setattr(payload, field, value)
    return getattr(messaging, name)().write(payload)
class Hinges:
    def __init__(self, craft, bodies):
        self.effector = effector = spinningBodyNDOFStateEffector.SpinningBodyNDOFStateEffector()
        for R, p, axis, m, c, J, *forces in bodies:
            body = spinningBodyNDOFStateEffector.SpinningBody()
            body.setMass(m), body.setISPntSc_S(J.tolist()), body.setDCM_S0P(R.T.tolist())
            body.setR_ScS_S(column(c)), body.setR_SP_P(column(p)), body.setSHat_S(column(axis))
            body.setK(forces[0]), body.setC(forces[1])
            effector.addSpinningBody(body)
        for k, rest in enumerate(b[-1] for b in bodies):
            effector.spinningBodyRefInMsgs[k].subscribeTo(self.keep(message('HingedRigidBodyMsg', theta=rest)))
        craft.addStateEffector(effector)
    def has(self, name): return self.craft.dynManager.getStateObject(name) is not None
    def keep(self, one):
        self.kept = getattr(self, 'kept', []) + [one]
        return one
    def push(self, forces):
        self.effector.motorTorqueInMsg.subscribeTo(self.keep(message('ArrayMotorTorqueMsg', motorTorque=list(forces))))
    def names(self):
        e = self.effector
        return [(e.getNameOfThetaState(), e.getNameOfThetaDotState())]
    def logs(self): return list(self.effector.spinningBodyConfigLogOutMsgs)
class OneHinge(Hinges):
    def __init__(self, craft, bodies):
        ((R, p, axis, m, c, J, k, d, rest),) = bodies
        self.effector = e = spinningBodyOneDOFStateEffector.SpinningBodyOneDOFStateEffector()
        e.mass, e.IPntSc_S, e.r_ScS_S, e.r_SB_B, e.sHat_S = m, J.tolist(), column(c), column(p), column(axis)
        e.dcm_S0B, e.k, e.c = R.T.tolist(), k, d
        e.spinningBodyRefInMsg.subscribeTo(self.keep(message('HingedRigidBodyMsg', theta=rest)))
        craft.addStateEffector(e)
    def names(self): return [(self.effector.nameOfThetaState, self.effector.nameOfThetaDotState)]
    def logs(self): return [self.effector.spinningBodyConfigLogOutMsg]
class TwoHinges(Hinges):
    def __init__(self, craft, bodies):
        (R, p, axis, m, c, J, k, d, rest), (S, r, second, n, b, I, l, f, last) = bodies
        self.effector = e = spinningBodyTwoDOFStateEffector.SpinningBodyTwoDOFStateEffector()
        e.mass1, e.IS1PntSc1_S1, e.r_Sc1S1_S1, e.r_S1B_B, e.s1Hat_S1 = m, J.tolist(), column(c), column(p), column(axis)
        e.mass2, e.IS2PntSc2_S2, e.r_Sc2S2_S2, e.r_S2S1_S1 = n, I.tolist(), column(b), column(r)
        e.s2Hat_S2 = column(second)
        e.dcm_S10B, e.dcm_S20S1, e.k1, e.k2, e.c1, e.c2 = R.T.tolist(), S.T.tolist(), k, l, d, f
        for number, at in enumerate((rest, last)):
            e.spinningBodyRefInMsgs[number].subscribeTo(self.keep(message('HingedRigidBodyMsg', theta=at)))
        craft.addStateEffector(e)
    def names(self):
        e = self.effector
        return [(e.nameOfTheta1State, e.nameOfTheta1DotState), (e.nameOfTheta2State, e.nameOfTheta2DotState)]
class Slides(Hinges):
    def __init__(self, craft, bodies):
        self.effector = effector = linearTranslationNDOFStateEffector.LinearTranslationNDOFStateEffector()
        for R, p, axis, m, c, J, *forces in bodies:
            body = linearTranslationNDOFStateEffector.TranslatingBody()
            body.setMass(m), body.setIPntFc_F(J.tolist()), body.setDCM_FP(R.T.tolist())
            body.setR_FcF_F(column(c)), body.setR_F0P_P(column(p)), body.setFHat_P(column(R @ axis))
            body.setK(forces[0]), body.setC(forces[1])
            effector.addTranslatingBody(body)
        for k, rest in enumerate(b[-1] for b in bodies):
            at = message('LinearTranslationRigidBodyMsg', rho=rest)
            effector.translatingBodyRefInMsgs[k].subscribeTo(self.keep(at))
        craft.addStateEffector(effector)
    def push(self, forces):
        self.effector.motorForceInMsg.subscribeTo(self.keep(message('ArrayMotorForceMsg', motorForce=list(forces))))
    def names(self):
        e = self.effector
        return [(e.getNameOfRhoState(), e.getNameOfRhoDotState())]
    def logs(self): return list(self.effector.translatingBodyConfigLogOutMsgs)
class OneSlide(Slides):
    def __init__(self, craft, bodies):
        ((R, p, axis, m, c, J, k, d, rest),) = bodies
        self.effector = e = linearTranslationOneDOFStateEffector.LinearTranslationOneDOFStateEffector()
        e.setMass(m), e.setIPntFc_F(J.tolist()), e.setR_FcF_F(column(c)), e.setR_F0B_B(column(p))
        e.setFHat_B(column(R @ axis)), e.setDCM_FB(R.T.tolist()), e.setK(k), e.setC(d)
        e.translatingBodyRefInMsg.subscribeTo(self.keep(message('LinearTranslationRigidBodyMsg', rho=rest)))
        craft.addStateEffector(e)
    def names(self):
        if not hasattr(self, 'number'):
            # That of all such effectors there have been.
            module, names = linearTranslationOneDOFStateEffector, 'linearTranslationRho%d'
            self.number = next(k for k in range(getattr(module, 'last', 1), 10**6) if self.has(names % k))
            module.last = self.number
        return [('linearTranslationRho%d' % self.number, 'linearTranslationRhoDot%d' % self.number)]
    def logs(self): return [self.effector.translatingBodyConfigLogOutMsg]
class Panel(Hinges):
    def __init__(self, craft, bodies):
        ((R, p, axis, m, c, J, k, d, rest),) = bodies
        self.effector = e = hingedRigidBodyStateEffector.HingedRigidBodyStateEffector()
        e.mass, e.d, e.IPntS_S, e.r_HB_B, e.dcm_HB, e.k, e.c = m, -c[0], J.tolist(), column(p), R.T.tolist(), k, d
        e.hingedRigidBodyRefMsg.subscribeTo(self.keep(message('HingedRigidBodyMsg', theta=rest)))
        craft.addStateEffector(e)
    def names(self): return [(self.effector.nameOfThetaState, self.effector.nameOfThetaDotState)]
    def logs(self): return [self.effector.hingedRigidBodyConfigLogOutMsg]
class TwoPanels(TwoHinges):
    def __init__(self, craft, bodies):
        (R, p, axis, m, c, J, k, d, _), (_, r, _, n, b, I, l, f, _) = bodies
        self.effector = e = dualHingedRigidBodyStateEffector.DualHingedRigidBodyStateEffector()
        e.mass1, e.d1, e.l1, e.IPntS1_S1, e.r_H1B_B, e.dcm_H1B, e.k1, e.c1 = (
            m, -c[0], -r[0], J.tolist(), column(p), R.T.tolist(), k, d)
        e.mass2, e.d2, e.IPntS2_S2, e.k2, e.c2 = n, -b[0], I.tolist(), l, f
        craft.addStateEffector(e)
    def logs(self): return list(self.effector.dualHingedRigidBodyConfigLogOutMsgs)
class Panels(Hinges):
    def __init__(self, craft, bodies):
        self.effector = e = nHingedRigidBodyStateEffector.NHingedRigidBodyStateEffector()
        e.r_HB_B, e.dcm_HB = column(bodies[0][1]), bodies[0][0].T.tolist()
        for _, _, _, m, c, J, k, d, rest in bodies:
            panel = nHingedRigidBodyStateEffector.HingedPanel()
            panel.mass, panel.d, panel.IPntS_S, panel.k, panel.c, panel.theta_0 = m, -c[0], J.tolist(), k, d, rest
            e.addHingedPanel(panel)
        craft.addStateEffector(e)
    def push(self, forces): pass
    def names(self): return [(self.effector.nameOfThetaState, self.effector.nameOfThetaDotState)]
    def logs(self): return list(self.effector.nHingedRigidBodyConfigLogOutMsgs)
class Particle(Hinges):
    def logs(self): return []
    def __init__(self, craft, bodies):
        ((R, p, axis, m, c, J, k, d, rest),) = bodies
        self.effector = e = linearSpringMassDamper.LinearSpringMassDamper()
        e.massInit, e.k, e.c, e.r_PB_B, e.pHat_B = m, k, d, column(p), column(R @ axis)
        craft.addStateEffector(e)
    def push(self, forces): pass
    def names(self): return [(self.effector.nameOfRhoState, self.effector.nameOfRhoDotState)]
class Wheel(Hinges):
    def logs(self): return []
    def __init__(self, craft, bodies):
        self.effector = e = reactionWheelStateEffector.ReactionWheelStateEffector()
        self.kept, self.is_balanced = [], True
        for R, p, axis, m, c, J, *_ in bodies:
            wheel = reactionWheelStateEffector.RWConfigPayload()
            wheel.gsHat_B, wheel.w2Hat0_B, wheel.w3Hat0_B = (column(R[:, k]) for k in range(3))
            wheel.rWB_B, wheel.mass, wheel.Js, wheel.Jt, wheel.Jg = column(p), m, J[0, 0], J[1, 1], J[2, 2]
            wheel.u_max, wheel.u_min, wheel.Omega_max = -1.0, 0.0, -1.0
            wheel.RWModel = messaging.JitterFullyCoupled if m else messaging.BalancedWheels
            if not m: craft.hub.IHubPntBc_B = (np.array(craft.hub.IHubPntBc_B) + R @ J @ R.T).tolist()
            if m: wheel.U_s, wheel.U_d, self.is_balanced = m * c[1], J[0, 2], False
            e.addReactionWheel(self.keep(wheel))
        craft.addStateEffector(e)
    def push(self, forces):
        self.effector.rwMotorCmdInMsg.subscribeTo(self.keep(message('ArrayMotorTorqueMsg', motorTorque=list(forces))))
    def names(self):
        names = self.effector.nameOfReactionWheelThetasState, self.effector.nameOfReactionWheelOmegasState
        return [names[::-1][:1] * 2 if self.is_balanced else names]
class Craft:
    def __init__(self, classes):
        self.craft = craft = spacecraft.Spacecraft()
        craft.hub.mHub, craft.hub.r_BcB_B, craft.hub.IHubPntBc_B = hub[0], column(hub[1]), hub[2].tolist()
        self.parts = []
        # Wheels have one effector.
        for kind, lots in groupby(chains, lambda chain: chain[0]):
            lots = [bodies for _, bodies in lots]
            lots = [sum(lots, [])] if classes[kind] is Wheel else lots
            for bodies in lots:
                self.parts.append(classes[kind](craft, bodies))
                self.parts[-1].craft = craft
        # What nobody listens to is not written.
        self.listening = [log.recorder() for part in self.parts for log in part.logs()]
        self.outside = extForceTorque.ExtForceTorque()
        craft.addDynamicEffector(self.outside)
        craft.Reset(0)
        for part in self.parts: part.effector.Reset(0)
    def state(self, name): return self.craft.dynManager.getStateObject(name)
    def each(self):
        at = 0
        for part in self.parts:
            for place, rate in part.names():
                size = len(np.ravel(self.state(place).getState()))
                yield part, place, rate, slice(at, at + size)
                at += size
    def set(self, q, v, tau=None):
        for name, x in (('Position', q[:3]), ('Velocity', v[:3]), ('Sigma', mrp(q[3:7])), ('Omega', v[3:6])):
            self.state('hub' + name).setState(column(x))
        for part, place, rate, at in self.each():
            self.state(place).setState(column(q[7:][at])), self.state(rate).setState(column(v[6:][at]))
        tau = 0 * v if tau is None else tau
        self.outside.extForce_N, self.outside.extTorquePntB_B = column(tau[:3]), column(tau[3:6])
        at = 6
        for part in self.parts:
            size = sum(len(np.ravel(self.state(place).getState())) for place, _ in part.names())
            part.push(tau[at:at + size])
            at += size
            part.effector.UpdateState(0)
    def rates(self, q, v, tau=None):
        self.set(q, v, tau)
        self.craft.equationsOfMotion(0.0, 1.0)
        found = [np.ravel(self.state(name).getStateDeriv()) for name in ('hubVelocity', 'hubOmega')]
        return np.concatenate([*found, *(np.ravel(self.state(rate).getStateDeriv()) for _, _, rate, _ in self.each())])
    def poses(self):
        hubs = self.craft.scStateOutMsg.read()
        found = [[*hubs.r_BN_N, *turned(np.array(hubs.sigma_BN)).flat]]
        centres = (body[4] for _, bodies in chains for body in bodies)
        for log, c in zip((one for part in self.parts for one in part.logs()), centres):
            log = log.read()
            R = turned(np.array(log.sigma_BN))
            found.append([*(np.array(log.r_BN_N) - R @ c), *R.flat])
        return found
    def moved(self, q, v, tau, step):
        self.set(q, v, tau)
        time = round(1e9 * step)
        self.craft.UpdateState(time)
        for part in self.parts: part.effector.UpdateState(time)
        return self.poses()
    def logs_against_states(self, q, v, tau, step):
        logged = np.array(self.moved(q, v, tau, step))
        made, states = [logged[0]], iter(np.concatenate(
            [np.ravel(self.state(place).getState()) for _, place, _, _ in self.each()] or [np.zeros(0)]))
        for kind, bodies in chains:
            p, R = logged[0][:3], logged[0][3:].reshape(3, 3)
            for turned_by, moved_by, axis, *_ in bodies:
                x, p, R = next(states), p + R @ moved_by, R @ turned_by
                p, R = (p + x * R @ axis, R) if kind == 'slide' else (p, R @ about(axis, x))
                made.append(np.array([*p, *R.flat]))
        return 1 + logged - made
    def totals(self):
        self.craft.computeEnergyMomentum(0.0)
        return self.craft"""
