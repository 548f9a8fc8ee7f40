# trimesh 5.2.0, primitive sphere of a density: primitives: volume, moment_inertia is wrong (mass, mass centre, moments about it xx, yy, zz, xy, xz, yz of the only link).
import numpy as np
import trimesh
def triangles(low, high):
    corners = [[(low, high)[k >> j & 1][j] for j in range(3)] for k in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))]
density = 0.060395054525
solid = trimesh.primitives.Sphere(radius=1.581138830084, center=[0.0, 0.0, 0.0])
solid.density = density
I = solid.moment_inertia
m = density * solid.volume
value = [m, *solid.center_mass, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]
import numpy as np
value, expected = np.reshape(value, (10,))[(4,)], 1.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
