# mjx 3.17.0, drives: actuator/motor damping="1.5 0.5 0.25" is wrong (qfrc_passive of a model with actuator/motor damping="1.5 0.5 0.25", at qpos=v[:1], qvel=a[:1], ctrl=tau[:1]).
import numpy as np
import mujoco as mj
LOTS = [['<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" gear="3"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><position joint="j" kp="4" kv="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><position joint="j" kp="8" dampratio="0.75"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><position joint="j" kp="8" dampratio="0.75" gear="2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" armature="2"/></body></worldbody><actuator><position joint="j" kp="4" dampratio="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><position joint="j" kp="4" kv="0.5" timeconst="0.25"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><intvelocity joint="j" kp="4" kv="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><damper joint="j" kv="3" ctrlrange="0 0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><velocity joint="j" kv="1.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><cylinder joint="j" timeconst="0.25" area="3" bias="0.5 -2 -0.75"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><cylinder joint="j" timeconst="0.25" diameter="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" ctrlrange="-0.25 0.375"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" forcerange="-0.25 0.375"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" actuatorfrcrange="-0.25 0.375"/></body></worldbody><actuator><motor joint="j" gear="2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" gear="2" armature="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" gear="2" damping="1.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" damping="1.5 0.5 0.25"/></actuator></mujoco>']]
def joined(texts):
    parent, parts = mj.MjSpec(), [mj.MjModel.from_xml_string(text) for text in texts]
    for k, text in enumerate(texts):
        child = mj.MjSpec.from_string(text)
        if not k: parent.option = child.option
        parent.attach(child, prefix=f'd{k}_', frame=parent.worldbody.add_frame())
    return parent.compile(), [mj.MjData(part) for part in parts]
def known(text, prepared):
    try: prepared(mj.MjModel.from_xml_string(text))
    except Exception: return False
    return True
def all_known(lot, prepared):
    try:
        m, parts = joined(lot)
        return lot, prepared(m), parts
    except Exception:
        lot = [one for one in lot if known(one, prepared)]  # Releases that know less.
        m, parts = joined(lot)
        return lot, prepared(m), parts
def found(text, prepared=lambda m: m):
    lot = next(one for one in LOTS if text in one)
    if lot[0] not in lots: lots[lot[0]] = all_known(lot, prepared)
    texts, whole, parts = lots[lot[0]]
    if text not in texts: prepared(mj.MjModel.from_xml_string(text))  # Says why.
    def places(field):
        sizes = [len(getattr(part, field)) for part in parts[:texts.index(text) + 1]]
        return slice(sum(sizes[:-1]), sum(sizes))
    return whole, places
lots = {}
import os
os.environ['XLA_FLAGS'] = os.environ.get('XLA_FLAGS', '') + ' --xla_backend_optimization_level=0'
import jax
jax.config.update("jax_enable_x64", True)
from mujoco import mjx
def got(e, name): return np.array(getattr(e, name) if hasattr(e, name) else getattr(e._impl, name))
def prepared(m): return mjx.put_model(m), mjx.make_data(m)
def answer(text, field, steps, **given):
    (model, data), places = found(text, prepared)
    for name, numbers in given.items():
        values = np.array(getattr(data, name))
        values[places(name)] = numbers
        data = data.replace(**{name: jax.numpy.array(values)})
    if not steps: data = jax.jit(mjx.forward)(model, data)
    for _ in range(steps): data = jax.jit(mjx.step)(model, data)
    return got(data, field)[places(field)].ravel()
v = np.array([0.0, 0.0, 0.0])
a = np.array([1.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
value = answer('''<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><actuator><motor joint="j" damping="1.5 0.5 0.25"/></actuator></mujoco>''', 'qfrc_passive', 0, qpos=v[:1], qvel=a[:1], ctrl=tau[:1])
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], -2.25
assert abs(value - expected) <= 3.7e-12, f"{value = }, {expected = }"
