"""A learned residual: what the equations of motion lack, fitted through the model's exact derivatives in PyTorch.

The "measured" cart has a drag that the model does not; a small network learns that force from accelerations, and a
motion predicted with it stays near the measured one. Needs the extra `torch`.
"""

import torch
from symofros.reference_models import MODELS

import symofros as sf

torch.manual_seed(0)
dynamics = sf.interop.torch.Dynamics(sf.compile(MODELS["cart_pole"]))


def drag(v):
    """What nobody modelled: a force against the cart's speed, of its square [N]."""
    return -0.8 * v[:, :1] * v[:, :1].abs()


q, v, u = (scale * torch.randn(400, n, dtype=torch.float64) for scale, n in ((1.0, 2), (1.5, 2), (3.0, 1)))
measured = dynamics.forward_dynamics(q, v, u + drag(v))
network = torch.nn.Sequential(torch.nn.Linear(2, 16), torch.nn.Tanh(), torch.nn.Linear(16, 1)).double()
optimiser = torch.optim.Adam(network.parameters(), lr=2e-2)
for epoch in range(401):
    loss = (dynamics.forward_dynamics(q, v, u + network(v)) - measured).square().mean()
    if epoch % 200 == 0:
        print(f"epoch {epoch}: mean squared error of the accelerations {loss.item():.1e}")
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()


def motion(residual):
    """The state after 1 s from a fast start, by semi-implicit steps of 10 ms."""
    at, speed = torch.tensor([[0.0, 2.6]], dtype=torch.float64), torch.tensor([[1.5, 0.0]], dtype=torch.float64)
    with torch.no_grad():
        for _ in range(100):
            speed = speed + 0.01 * dynamics.forward_dynamics(at, speed, residual(speed))
            at = at + 0.01 * speed
    return torch.cat([at, speed], dim=1)


truth = motion(drag)
without, learned = ((motion(each) - truth).norm().item() for each in (lambda v: 0 * v[:, :1], network))
print(f"after 1 s: {without:.3f} off without the network, {learned:.3f} with it: {without / learned:.0f} times nearer")
