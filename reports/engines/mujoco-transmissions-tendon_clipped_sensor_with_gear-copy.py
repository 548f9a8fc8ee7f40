# mujoco 4.0.0, transmissions: copy, tendon actuatorfrcrange, gear 3, tendonactuatorfrc is wrong (sensordata of a model with tendon actuatorfrcrange, gear 3, tendonactuatorfrc, at qpos=v[:1], ctrl=tau[:2]).
import numpy as np
import mujoco as mj
def compiled(text): return mj.MjSpec.from_string(text).copy().compile()
models = {}
def answer(text, field, steps, **given):
    if text not in models: models[text] = compiled(text)
    m = models[text]
    d = mj.MjData(m)
    for name, numbers in given.items(): getattr(d, name)[:] = numbers
    if not steps: mj.mj_forward(m, d)
    for _ in range(steps): mj.mj_step(m, d)
    return np.array(getattr(d if hasattr(d, field) else m, field), float).ravel()
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.6149502567089378, 0.0])
value = answer('''<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><tendon><fixed name="t" actuatorfrcrange="-0.5 0.75"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor name="m" tendon="t"/><motor tendon="t" gear="3"/></actuator><sensor><tendonactuatorfrc tendon="t"/></sensor></mujoco>''', 'sensordata', 0, qpos=v[:1], ctrl=tau[:2])
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.75
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
