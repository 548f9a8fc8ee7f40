"""What Newton's builder makes of numbers that are stated late, turned or with anchors, as states and meshes."""

from __future__ import annotations

from ..writing.source import ways_of

_MADE = "b = newton.ModelBuilder()\n"
_BODY = "body = b.add_link(mass=1.0)\n"
WAYS = ways_of(f"""
== coordinates_of_anchored | add_joint_free, parent_xform: joint_q
{_MADE}body = b.add_link(xform=wp.transform(v, wp.quat_identity()), mass=1.0)
b.add_articulation([b.add_joint_free(body, parent_xform=wp.transform(a, wp.quat_identity()))])
value = list(b.joint_q)[:3]
== velocity_of_turned_copy | add_world, add_builder: body_qd
{_MADE}{_BODY}b.body_qd[body] = wp.spatial_vector(*v, *a)
b.add_articulation([b.add_joint_free(body)])
c = newton.ModelBuilder()
(c.add_world if hasattr(c, 'add_world') else c.add_builder)(b, wp.transform((0, 0, 0), wp.quat(*q)))
value = list(c.body_qd[0])
== areas_of_triangles | add_triangles: tri_areas
x, y = np.abs(v)[:2] + 0.5
{_MADE}for p in ((0, 0, 0), (x, 0, 0), (0, y, 0), (2 * x, 0, 0), (0, 3 * y, 0)): b.add_particle(p, (0, 0, 0), 1.0)
b.add_triangles([0, 0, 0], [1, 1, 3], [2, 3, 4])
value = b.finalize(device='cpu').tri_areas.numpy()[:2]
""")
