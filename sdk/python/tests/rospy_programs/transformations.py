"""Values of `tf.transformations`."""
# needs: numpy
import math

import tf.transformations as t


def shown(text):
    def flat(value):
        try:
            return [flat(each) for each in value]
        except TypeError:
            return "%.6f" % (value + 0.0 if abs(value) > 1e-9 else 0.0)

    try:
        print(text, flat(eval(text)))
    except Exception as error:
        print(text, type(error).__name__, error)


q = t.quaternion_from_euler(0.1, -0.2, 0.3)
p = t.quaternion_from_euler(1.1, 0.2, -2.3)
m = t.quaternion_matrix(q)
for text in (
    "q", "t.quaternion_from_euler(0, 0, math.pi / 2)", "t.quaternion_from_euler(0.1, 0.2, 0.3, 'rzyx')", "t.euler_from_quaternion(q)",
    "t.euler_from_quaternion(q, 'syxz')", "t.euler_from_quaternion([0, 0, 0, 1])", "t.quaternion_multiply(q, p)", "t.quaternion_inverse(q)",
    "t.quaternion_conjugate(q)", "t.quaternion_matrix(q)", "t.quaternion_from_matrix(m)", "t.quaternion_slerp(q, p, 0.25)",
    "t.quaternion_slerp(q, p, 0)", "t.quaternion_slerp(q, q, 0.5)", "t.quaternion_about_axis(0.5, (0, 0, 1))", "t.quaternion_about_axis(0.5, (1, 2, 3))",
    "t.euler_matrix(0.1, 0.2, 0.3)", "t.euler_from_matrix(m)", "t.translation_matrix((1, 2, 3))", "t.translation_from_matrix(t.translation_matrix((1, 2, 3)))",
    "t.rotation_matrix(0.5, (0, 0, 1))", "t.inverse_matrix(t.translation_matrix((1, 2, 3)))", "t.concatenate_matrices(m, t.translation_matrix((1, 2, 3)))",
    "t.identity_matrix()", "t.unit_vector((3, 4, 0))", "t.vector_norm((3, 4, 0))", "t.quaternion_from_euler(math.pi, 0, 0)",
    "t.euler_from_quaternion(t.quaternion_from_euler(0, math.pi / 2, 0))", "t.quaternion_matrix([0, 0, 0, 2])", "t.quaternion_matrix([0, 0, 0, 0])",
    "t.is_same_transform(m, m)", "t.quaternion_from_euler(1)", "t.quaternion_from_euler(1, 2, 3, 'nothing')",
):  # fmt: skip
    shown(text)
