"""Text of the calls of `exudyn`: how links move, and Exudyn's system of them as functions of a state."""

# `links`: parent; placements with the motions that follow them; mass, mass centre, inertia about the origin.
# `special`, `generic`, `loops`: connectors: class, its ends (link, rotation, position), its arguments.
MOVED = """def cross(w, columns): return np.cross(w, columns, axis=0)
def turn(u, angle):
    K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
def moved(q, v):
    frames = []
    for parent, steps, *_ in links:
        R, p, Jp, Jw, a, c = frames[parent] if parent >= 0 else (
            np.eye(3), np.zeros(3), np.zeros((3, n)), np.zeros((3, n)), np.zeros(3), np.zeros(3))
        Jp, Jw = Jp.copy(), Jw.copy()
        for R_before, p_before, kind, axis, i, k in steps:
            r, w = R @ p_before, Jw @ v
            Jp += -cross(r[:, None], Jw)
            a, p, R = a + np.cross(c, r) + np.cross(w, np.cross(w, r)), p + r, R @ R_before
            u = R @ axis
            if kind == "slide":
                r, fast = u * q[i], u * v[k]
                Jp += -cross(r[:, None], Jw)
                Jp[:, k] += u
                a, p = a + np.cross(c, r) + np.cross(w, np.cross(w, r)) + 2 * np.cross(w, fast), p + r
            elif kind == "hinge":
                c, R = c + np.cross(w, u * v[k]), R @ turn(axis, q[i])
                Jw[:, k] += u
            elif kind == "ball":
                s, e = q[i], q[i + 1:i + 4]
                K = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
                R = R @ (np.eye(3) + 2 * s * K + 2 * K @ K)
                c = c + np.cross(w, R @ v[k:k + 3])
                Jw[:, k:k + 3] += R
        frames.append((R, p, Jp, Jw, a, c))
    return frames"""
SYSTEM = """def names_of(item): return item.__init__.__code__.co_varnames
def body_of(number, mass, com, J):
    # Older releases have longer names.
    named = ("mass", "centerOfMass", "inertia")
    if named[0] not in names_of(items.ObjectRigidBody): named = ("physicsMass", "physicsCenterOfMass", "physicsInertia")
    return items.ObjectRigidBody(nodeNumber=number, **dict(zip(named, (mass, com, J))))
class System:
    def __init__(self, node, joints):
        self.node, self.container = node, exu.SystemContainer()
        self.mbs = mbs = self.container.AddSystem()
        ground = mbs.AddObject(items.ObjectGround())
        still = [0, 0, 0, 1, 0, 0, 0] if node == "EP" else [0] * 6
        self.bodies = []
        for _, _, mass, com, J in links:
            number = mbs.AddNode(getattr(items, "NodeRigidBody" + node)(referenceCoordinates=still))
            self.bodies.append(mbs.AddObject(body_of(number, mass, com, J)))
            at = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=self.bodies[-1]))
            mbs.AddLoad(items.LoadMassProportional(markerNumber=at, loadVector=gravity))
        self.joints = []
        for name, ends, arguments in joints:
            kind, turned = getattr(items, name), {}
            if hasattr(exu, "HT"):
                places = [{"localHT": exu.HT(rotation=R, translation=p)} for _, R, p in ends]
            else:
                places = [{"localPosition": p} for _, _, p in ends]
                turned = {f"rotationMarker{k}": R for k, (_, R, _) in enumerate(ends)}
                turned = {one: R for one, R in turned.items() if one in names_of(kind)}
            markers = [mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=self.bodies[k] if k >= 0 else ground, **place))
                for (k, _, _), place in zip(ends, places)]
            self.joints.append(mbs.AddObject(kind(markerNumbers=markers, **turned, **arguments)))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        if hasattr(settings, 'solution'): settings.solution.file.write, settings.solution.file.name = False, ''
        else: settings.solutionSettings.writeSolutionToFile = False
        settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
        self.solver = exu.MainSolverImplicitSecondOrder()
        self.solver.InitializeSolver(mbs, settings)
    def coordinates(self, q, v):
        x, D, s = [], [], []
        for R, p, Jp, Jw, a, c in moved(q, v):
            w = Jw @ v
            if self.node == "EP":
                e = quaternion(R)
                H = np.array([[-e[1:][k] for k in range(3)], *(e[0] * np.eye(3) - np.array(
                    [[0, -e[3], e[2]], [e[3], 0, -e[1]], [-e[2], e[1], 0]]))]) / 2
                x, rates, second = [*x, *p, *(e - [1, 0, 0, 0])], H @ Jw, H @ c - (w @ w) / 4 * e
            elif self.node == "Rxyz":
                angles = np.arctan2(-R[1, 2], R[2, 2]), np.arcsin(R[0, 2]), np.arctan2(-R[0, 1], R[0, 0])
                first, across = turn([1, 0, 0], angles[0])[:, 1], R @ turn([0, 0, 1], -angles[2])[:, 2]
                G = np.stack([np.eye(3)[0], first, across], axis=1)
                r = np.linalg.solve(G, w)
                w1, w2 = r[0] * G[:, 0], r[0] * G[:, 0] + r[1] * first
                drift = r[1] * np.cross(w1, first) + r[2] * np.cross(w2, across)
                x, rates, second = [*x, *p, *angles], np.linalg.solve(G, Jw), np.linalg.solve(G, c - drift)
            else:
                e = quaternion(R)
                angle = 2 * np.arctan2(np.linalg.norm(e[1:]), e[0])
                x, rates, second = [*x, *p, *(angle / np.sin(angle / 2) * e[1:] if angle else e[1:])], R.T @ Jw, R.T @ c
            D, s = [*D, *Jp, *rates], [*s, *a, *second]
        return np.array(x), np.array(D), np.array(s)
    def set(self, x, rate):
        data, now = self.mbs.systemData, exu.ConfigurationType.Current
        data.SetODE2Coordinates(x, configuration=now)
        data.SetODE2Coordinates_t(rate, configuration=now)
    def at(self, q, v):
        x, D, s = self.coordinates(q, v)
        self.set(x, D @ v)
        self.solver.ComputeMassMatrix(self.mbs)
        M = np.array(self.solver.GetSystemMassMatrix())
        self.solver.ComputeODE2RHS(self.mbs)
        return x, D, s, M, np.array(self.solver.GetSystemResidual())[:len(x)]
    def jacobian(self, x):
        self.set(x, 0 * x)
        self.solver.ComputeJacobianODE2RHS(self.mbs, scalarFactor_ODE2=0.0, scalarFactor_ODE2_t=0.0)
        self.solver.ComputeJacobianAE(self.mbs)
        return np.array(self.solver.GetSystemJacobian())[len(x):, :len(x)]
    def solved(self, q, v, tau, step):
        x, D, s, M, f = self.at(q, v)
        C, rate = self.jacobian(x), D @ v
        h, drift = step / max(1.0, np.abs(rate.reshape(len(links), -1)[:, 3:]).max()), 0.0
        for k, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
            drift += weight / h * (self.jacobian(x + k * h * rate) - self.jacobian(x - k * h * rate)) @ rate
        f = f + D @ np.linalg.solve(D.T @ D, tau)
        # Units that make every mass 1 and every condition of length 1: masses of 1e8 would hide those of 1e-8.
        # What of a body's inertia is rounding, as about a slender rod's axis, gives no unit.
        own = np.diag(M).reshape(len(links), -1)
        S = 1 / np.sqrt(np.where(own > 1e-12 * own.max(axis=1, keepdims=True), own, 1.0).ravel())
        # Conditions of rounding alone, of what a joint leaves free, are none.
        lengths, real = np.linalg.norm(C * S, axis=1), np.linalg.norm(C, axis=1)
        rows = np.where(real > 1e-12 * np.max(real, initial=0.0), 1 / np.where(lengths > 0, lengths, 1.0), 0.0)
        M, C, f, drift = S[:, None] * M * S, rows[:, None] * C * S, S * f, rows * drift
        U, sigma, Vt = np.linalg.svd(C)
        rank = int(np.sum(sigma > 1e-10 * sigma[0])) if len(sigma) else 0
        Y, Z = Vt[:rank].T, Vt[rank:].T
        X, L = np.zeros(len(x), np.longdouble), np.zeros(len(C), np.longdouble)
        for _ in range(30):
            left, gap = (f - M @ X - C.T @ L).astype(float), (-drift - C @ X).astype(float)
            least = Y @ (U[:, :rank].T @ gap / sigma[:rank])
            change = least + Z @ np.linalg.solve(Z.T @ M @ Z, Z.T @ (left - M @ least))
            L += U[:, :rank] @ (Y.T @ (left - M @ change) / sigma[:rank])
            X += change
        X, L = S * X, rows * L
        xtt, lam = X.astype(float), L.astype(float)
        return np.linalg.lstsq(D, xtt - s, rcond=None)[0], lam
    def outputs(self, q, v, a, *names):
        x, D, s = self.coordinates(q, v)
        self.set(x, D @ v)
        self.mbs.systemData.SetODE2Coordinates_tt(D @ a + s, configuration=exu.ConfigurationType.Current)
        types = [getattr(exu.OutputVariableType, name) for name in names]
        now = exu.ConfigurationType.Current
        return [np.concatenate([np.ravel(self.mbs.GetObjectOutputBody(b, kind, [0, 0, 0], now)) for kind in types])
            for b in self.bodies]
    def reactions(self, q, v, tau, name):
        lam = self.solved(q, v, tau, 4e-3)[1]
        x, D, _ = self.coordinates(q, v)
        self.set(x, D @ v)
        self.mbs.systemData.SetAECoordinates(lam, configuration=exu.ConfigurationType.Current)
        kind = getattr(exu.OutputVariableType, name)
        return [self.mbs.GetObjectOutput(joint, kind) for joint in self.joints[-len(points):]]"""
QUATERNION = """def quaternion(R):
    w = np.sqrt(max(0.0, 1 + np.trace(R))) / 2
    if w > 0.1:
        return np.array([w, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / [1, 4 * w, 4 * w, 4 * w]
    k = int(np.argmax(np.diagonal(R)))
    i, j = (k + 1) % 3, (k + 2) % 3
    e = np.zeros(4)
    e[1 + k] = np.sqrt(1 + R[k, k] - R[i, i] - R[j, j]) / 2
    e[0], e[1 + i], e[1 + j] = np.array([R[j, i] - R[i, j], R[i, k] + R[k, i], R[j, k] + R[k, j]]) / (4 * e[1 + k])
    return e"""
