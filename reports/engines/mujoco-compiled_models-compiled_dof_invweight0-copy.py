# mujoco 4.0.0, compiled models: copy, dof_invweight0 is wrong (dof_invweight0 of a model with dof_invweight0, at ).
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
value = answer('''<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" armature="0.5" ref="0.25"/></body></worldbody><tendon><fixed name="t"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor joint="j" gear="3"/></actuator></mujoco>''', 'dof_invweight0', 0)
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.4
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
