"""Points that learn where their cells' volumes are as wanted: gradients in PyTorch."""

import torch

import laguerre as lg
from laguerre.torch import cells

points = torch.rand(200, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(4)).requires_grad_()
for step in range(20):
    volume, centroid = cells(points, domain=lg.Box(0, 1))
    loss = ((200 * volume - 1) ** 2).mean()
    points.data -= 0.05 * torch.autograd.grad(loss, points)[0]
    print(f"step {step}: mean square deviation {loss.item():.4f}")
