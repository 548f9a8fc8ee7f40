# mujoco 4.0.0, transmissions: among others, tendon actuatorfrcrange, gear 3 is wrong (qfrc_actuator of a model with tendon actuatorfrcrange, gear 3, at qpos=v[:1], ctrl=tau[:2]).
import numpy as np
import mujoco as mj
def compiled(text): return mj.MjModel.from_xml_string(text)
LOTS = [['<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><motor joint="j" gear="0.5 -1 2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><motor jointinparent="j" gear="0.5 -1 2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><position joint="j" gear="0 0 1" kp="3"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><orientation joint="j" kp="4" kv="0.5"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><orientation joint="j" kp="4" kv="0.5" input="quat"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="ball"/></body></worldbody><actuator><orientation joint="j" kp="4" kv="0.5" forcerange="0 2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><freejoint name="j"/></body></worldbody><actuator><motor joint="j" gear="1 -2 3 0.5 -1 2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><freejoint name="j"/></body></worldbody><actuator><motor jointinparent="j" gear="1 -2 3 0.5 -1 2"/></actuator></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><site name="w" pos="-1.0 0.5 0.25"/><site name="o" pos="2.0 -1.0 0.5"/><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /><site name="p" pos="0.25 0.125 -0.5"/></body></worldbody><tendon><spatial name="t"><site site="w"/><site site="p"/><pulley divisor="4"/><site site="o"/><site site="p"/></spatial></tendon></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><site name="w" pos="-1.0 0.5 0.25"/><site name="o" pos="2.0 -1.0 0.5"/><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /><site name="p" pos="0.25 0.125 -0.5"/></body></worldbody><tendon><spatial name="t"><pulley divisor="2"/><site site="w"/><site site="p"/><pulley divisor="4"/><site site="o"/><site site="p"/></spatial></tendon></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><site name="w" pos="-1.0 0.5 0.25"/><site name="o" pos="2.0 -1.0 0.5"/><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /><site name="p" pos="0.25 0.125 -0.5"/></body></worldbody><tendon><spatial name="t" stiffness="3" springlength="1"><site site="w"/><site site="p"/><pulley divisor="4"/><site site="o"/><site site="p"/></spatial></tendon></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><tendon><fixed name="t" actuatorfrcrange="-0.5 0.75"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor name="m" tendon="t"/><motor tendon="t" gear="1"/></actuator><sensor><tendonactuatorfrc tendon="t"/></sensor></mujoco>', '<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><tendon><fixed name="t" actuatorfrcrange="-0.5 0.75"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor name="m" tendon="t"/><motor tendon="t" gear="3"/></actuator><sensor><tendonactuatorfrc tendon="t"/></sensor></mujoco>'], ['<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><geom type="plane" size="4 4 1"/><body name="b" pos="0 0 0.25"><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="0 0 1"/><geom type="sphere" size="0.25" margin="0" gap="0.25"/></body></worldbody><actuator><adhesion body="b" ctrlrange="0 0.5" gain="3"/></actuator></mujoco>']]
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
def among(text, field, steps, **given):
    m, places = found(text)
    d = mj.MjData(m)
    for name, numbers in given.items(): getattr(d, name)[places(name)] = numbers
    if not steps: mj.mj_forward(m, d)
    for _ in range(steps): mj.mj_step(m, d)
    return np.array(getattr(d, field)[places(field)], float).ravel()
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
tau = np.array([0.0, 1.0, 0.0])
value = among('''<mujoco><compiler angle="radian"/><option timestep="0.015625" gravity="0 0 0" ></option><worldbody><body name="b" ><inertial pos="0 0 0" mass="2" diaginertia="0.125 0.125 0.125"/><joint name="j" type="slide" axis="1 0 0" /></body></worldbody><tendon><fixed name="t" actuatorfrcrange="-0.5 0.75"><joint joint="j" coef="2"/></fixed></tendon><actuator><motor name="m" tendon="t"/><motor tendon="t" gear="3"/></actuator><sensor><tendonactuatorfrc tendon="t"/></sensor></mujoco>''', 'qfrc_actuator', 0, qpos=v[:1], ctrl=tau[:2])
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 1.5
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
