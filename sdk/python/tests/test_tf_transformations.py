"""`tf.transformations`: rotations in all their forms, by the mathematics; and that numpy is needed only for arrays."""

import importlib.util
import math
import os
import random
import subprocess
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [ROOT, os.path.join(ROOT, "ros1")]

from hrdsl.frames import rigid  # noqa: E402

HAS_NUMPY = importlib.util.find_spec("numpy") is not None


def product(a, b):
    return [[sum(a[row][at] * b[at][column] for at in range(3)) for column in range(3)] for row in range(3)]


def about(axis, angle):
    """The matrix about an axis, as a book has it."""
    c, s = math.cos(angle), math.sin(angle)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    matrix = [[0.0] * 3 for _ in range(3)]
    matrix[axis][axis] = 1.0
    matrix[one][one] = matrix[other][other] = c
    matrix[one][other], matrix[other][one] = -s, s
    return matrix


class Numbers(unittest.TestCase):
    def near(self, a, b, places=12):
        for one, other in zip(a, b):
            if isinstance(one, (list, tuple)):
                self.near(one, other, places)
            else:
                self.assertAlmostEqual(one, other, places)

    def test_euler_angles_of_all_conventions(self):
        chance = random.Random(3)
        for name in rigid.CONVENTIONS:
            for _ in range(10):
                angles = [chance.uniform(-3, 3) for _ in range(3)]
                axes = ["xyz".index(letter) for letter in name[1:]]
                matrices = [about(axis, angle) for axis, angle in zip(axes, angles)]
                if name[0] == "s":  # about axes that stay: the first is applied first
                    matrices.reverse()
                expected = product(product(matrices[0], matrices[1]), matrices[2])
                quaternion = rigid.quaternion(*angles, axes=name)
                self.near(rigid.rows(quaternion), expected)
                again = rigid.euler(expected, name)
                self.near(rigid.rows(rigid.quaternion(*again, axes=rigid.CONVENTIONS[name])), expected, 9)

    def test_gimbal_lock(self):
        matrix = rigid.rows(rigid.quaternion(0.3, math.pi / 2, 0.0))
        roll, pitch, yaw = rigid.euler(matrix)
        self.assertAlmostEqual(pitch, math.pi / 2)
        self.near(rigid.rows(rigid.quaternion(roll, pitch, yaw)), matrix, 7)

    def test_quaternions_and_matrices(self):
        chance = random.Random(4)
        for _ in range(200):
            q = [chance.gauss(0, 1) for _ in range(4)]
            length = math.sqrt(sum(part * part for part in q))
            q = [part / length for part in q]
            back = rigid.from_rows(rigid.rows([7 * part for part in q]))
            sign = 1 if sum(a * b for a, b in zip(q, back)) > 0 else -1
            self.near(back, [sign * part for part in q])
            self.near(rigid.multiply(q, rigid.conjugate(q)), (0, 0, 0, 1))
            v = [chance.gauss(0, 1) for _ in range(3)]
            self.near(rigid.rotate(q, v), rigid.place((0, 0, 0), q, v))

    def test_the_way_between_two_rotations(self):
        a, b = rigid.quaternion(0, 0, 0.2), rigid.quaternion(0, 0, 1.2)
        self.near(rigid.slerp(a, b, 0.3), rigid.quaternion(0, 0, 0.5))
        self.near(rigid.slerp(a, [-part for part in b], 0.3), rigid.quaternion(0, 0, 0.5))
        self.near(rigid.slerp(a, a, 0.3), a)

    def test_names_of_no_convention(self):
        for wrong in ("sxyy", "x", (9, 0, 0, 0)):
            with self.assertRaises(KeyError):
                rigid.convention(wrong)


class Transformations(unittest.TestCase):
    """In a process of its own, since the package `tf` needs messages."""

    def run_text(self, text, blocked=False):
        lines = ["import sys, types", "sys.path[:0] = %r" % [ROOT, os.path.join(ROOT, "ros1")]]
        lines += ["tf = sys.modules['tf'] = types.ModuleType('tf')", "tf.__path__ = [sys.path[1] + '/tf']"]
        lines += ["sys.modules['numpy'] = None"] if blocked else []
        lines += ["import math", "from tf import transformations as t", text]
        done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def test_without_numpy(self):
        text = """
print(*("%.3f" % abs(angle) for angle in t.euler_from_quaternion((0, 0, math.sin(0.25), math.cos(0.25)))))
try:
    t.quaternion_from_euler(0, 0, 1)
except ImportError as error:
    print(error)
try:
    t.clip_matrix(1)
except NotImplementedError as error:
    print(error)
print(hasattr(t, "nonsense"))
"""
        out = self.run_text(text, blocked=True)
        self.assertEqual(out[0], "0.000 0.000 0.500")
        self.assertIn("add a line `numpy` to requirements.txt", out[1])
        self.assertTrue(out[2].startswith("tf.transformations.clip_matrix is not there in hrdsl"), out[2])
        self.assertEqual(out[3], "False")

    @unittest.skipUnless(HAS_NUMPY, "numpy is not installed")
    def test_arrays(self):
        text = """
import numpy as n
near = n.allclose
q = t.quaternion_from_euler(0.1, -0.2, 0.3)
assert isinstance(q, n.ndarray) and near(t.quaternion_matrix(q), t.euler_matrix(0.1, -0.2, 0.3))
assert near(t.euler_from_matrix(t.euler_matrix(1, 0.5, -2, "rzyx"), "rzyx"), (1, 0.5, -2))
assert near(t.quaternion_from_matrix(t.quaternion_matrix(q)), q)
assert near(t.quaternion_multiply(q, t.quaternion_inverse(q)), (0, 0, 0, 1))
assert near(t.quaternion_slerp((0, 0, 0, 1), t.quaternion_about_axis(1.0, (0, 0, 1)), 0.5), t.quaternion_from_euler(0, 0, 0.5))
m = t.rotation_matrix(0.7, (1, 2, 3), (4, 5, 6))
assert near(m @ (4, 5, 6, 1), (4, 5, 6, 1)) and near(t.rotation_matrix(*t.rotation_from_matrix(m)), m)
assert near(t.translation_from_matrix(t.translation_matrix((1, 2, 3))), (1, 2, 3))
given = ([1.5, 2, 0.5], [0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [1, 2, 3], [0, 0, 0, 1])
for back, part in zip(t.decompose_matrix(t.compose_matrix(*given)), given):
    assert near(back, part), (back, part)
r = t.reflection_matrix((1, 0, 0), (1, 0, 0))
assert near(r @ (3, 1, 1, 1), (-1, 1, 1, 1)) and near(t.concatenate_matrices(r, r), t.identity_matrix())
assert near(t.scale_matrix(2, (1, 1, 1)) @ (2, 2, 2, 1), (3, 3, 3, 1)) and t.is_same_transform(m, 2 * m)
points = n.random.rand(4, 6)
points[3] = 1
assert near(t.superimposition_matrix(points, m @ points), m)
assert near(t.unit_vector([[3, 4], [0, 2]], axis=1), [[0.6, 0.8], [0, 1]]) and t.vector_norm([3, 4]) == 5
assert near(t.inverse_matrix(m) @ m, t.identity_matrix()) and near(t.vector_norm(t.random_quaternion()), 1)
print("good")
"""
        self.assertEqual(self.run_text(text), ["good"])


if __name__ == "__main__":
    unittest.main()
