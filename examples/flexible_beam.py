"""A flexible beam: its first flapping frequency, how many shape functions that takes, and how spin stiffens it.

At rest it is 1.8751^2 sqrt(EI/(rhoA L^4)); with spin it stays below sqrt(w^2 + 1.193 spin^2), Rayleigh's quotient
of the mode at rest.
"""

import numpy as np

import symofros as sf

LENGTH, DENSITY, STIFFNESS = 8.0, 0.2, 570.0
EXACT = 1.8751040687**2 * np.sqrt(STIFFNESS / (DENSITY * LENGTH**4))


def rotor_blade(functions: int) -> sf.Model:
    """A beam on a hub that turns about z, with so many shape functions along the axis of spin."""
    hub = sf.Joint("hub", "revolute", axis=(0, 0, 1))
    blade = sf.Beam("blade", hub, length=LENGTH, rhoA=DENSITY, EI_y=STIFFNESS, bend_z=functions)
    return sf.compile(sf.System(f"blade_{functions}", [blade], gravity=(0, 0, 0)))


def first_frequency(model: sf.Model, spin: float) -> float:
    """The lowest flapping frequency [rad/s] while the hub's angle and speed are held."""
    steady = sf.equilibrium(model, v={"hub": spin}, held=["hub"])
    return float(min(f for f in sf.modes(model, steady.q, steady.v).frequencies if f > 1e-3))


print("functions   error at rest")
for functions in (1, 2, 3):
    print(f"{functions:5d}       {first_frequency(rotor_blade(functions), 0.0) / EXACT - 1:12.2e}")
model = rotor_blade(3)
print("spin [rad/s]   first frequency [rad/s]   bound")
for spin in (0.0, 2.0, 4.0, 6.0):
    print(f"{spin:8.1f}       {first_frequency(model, spin):14.4f}   {np.sqrt(EXACT**2 + 1.193 * spin**2):18.4f}")
