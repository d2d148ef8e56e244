"""Rotations, quaternions and matrices of 4 by 4, with the interface of ROS's `tf.transformations`.

Quaternions are (x, y, z, w). What the original returns as an array is one of numpy, which is imported when the first such
function is called; `euler_from_quaternion` and its like, which return numbers, do without.
"""

from __future__ import annotations

import math

from hrdsl.frames import rigid

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _Numpy:
    """Stands for numpy until something of it is needed."""

    def __getattr__(self, name: str) -> Any:
        global numpy
        try:
            import numpy as found
        except ModuleNotFoundError:
            raise ImportError(
                "tf.transformations returns arrays of numpy, which is not installed: add a line `numpy` to"
                " requirements.txt beside the scenario"
            ) from None
        numpy = found
        return getattr(found, name)


numpy: Any = _Numpy()

_EPS = rigid.EPSILON
_AXES2TUPLE = rigid.CONVENTIONS
_TUPLE2AXES = {numbers: name for name, numbers in _AXES2TUPLE.items()}


def _copy(data: Any) -> Any:
    return numpy.array(data, dtype=numpy.float64, copy=True)


def _view(data: Any) -> Any:
    return numpy.asarray(data, dtype=numpy.float64)


# ── vectors ──


def vector_norm(data: Any, axis: Any = None, out: Any = None) -> Any:
    """The length of a vector, or the lengths along an axis."""
    data = _copy(data)
    if out is not None:
        numpy.sqrt(numpy.sum(data * data, axis=axis), out)
        return None
    if data.ndim == 1:
        return math.sqrt(numpy.dot(data, data))
    return numpy.sqrt(numpy.atleast_1d(numpy.sum(data * data, axis=axis)))


def unit_vector(data: Any, axis: Any = None, out: Any = None) -> Any:
    """The vector with length 1, or vectors along an axis."""
    found = _copy(data)
    if found.ndim == 1:
        found /= math.sqrt(numpy.dot(found, found))
    else:
        length = numpy.sqrt(numpy.atleast_1d(numpy.sum(found * found, axis)))
        found /= length if axis is None else numpy.expand_dims(length, axis)
    if out is None:
        return found
    out[:] = found
    return None


def random_vector(size: Any) -> Any:
    """Random numbers of 0..1."""
    return numpy.random.random(size)


# ── matrices ──


def identity_matrix() -> Any:
    """The matrix that changes nothing."""
    return numpy.identity(4, dtype=numpy.float64)


def translation_matrix(direction: Any) -> Any:
    """The matrix that moves by a vector."""
    matrix = numpy.identity(4)
    matrix[:3, 3] = direction[:3]
    return matrix


def translation_from_matrix(matrix: Any) -> Any:
    """By which vector a matrix moves."""
    return _view(matrix)[:3, 3].copy()


def rotation_matrix(angle: float, direction: Any, point: Any = None) -> Any:
    """The matrix that rotates about an axis, through a point or the origin."""
    axis = unit_vector(direction[:3])
    cosine, sine = math.cos(angle), math.sin(angle)
    matrix = numpy.identity(4)
    across = numpy.array(((0.0, -axis[2], axis[1]), (axis[2], 0.0, -axis[0]), (-axis[1], axis[0], 0.0)))
    matrix[:3, :3] = cosine * numpy.identity(3) + (1.0 - cosine) * numpy.outer(axis, axis) + sine * across
    if point is not None:
        point = _view(point[:3])
        matrix[:3, 3] = point - numpy.dot(matrix[:3, :3], point)
    return matrix


def _own(matrix: Any, value: float = 1.0) -> Any:
    """A vector that the matrix only stretches, by this factor."""
    values, vectors = numpy.linalg.eig(matrix)
    places = numpy.where(abs(numpy.real(values) - value) < 1e-8)[0]
    if not len(places):
        raise ValueError("no unit eigenvector corresponding to eigenvalue %g" % value)
    return numpy.real(vectors[:, places[-1]]).squeeze()


def rotation_from_matrix(matrix: Any) -> Any:
    """The angle, the axis and a point of it, of a matrix that rotates."""
    matrix = _view(matrix)
    inner = matrix[:3, :3]
    direction = _own(inner.T)
    point = _own(matrix)
    point = point / point[3]
    cosine = (numpy.trace(inner) - 1.0) / 2.0
    # Twice the sine is the length of this vector, along the axis or against it.
    turning = numpy.array((inner[2, 1] - inner[1, 2], inner[0, 2] - inner[2, 0], inner[1, 0] - inner[0, 1]))
    return math.atan2(numpy.dot(turning, direction) / 2.0, cosine), direction, point


def reflection_matrix(point: Any, normal: Any) -> Any:
    """The matrix that mirrors at a plane."""
    normal = unit_vector(normal[:3])
    matrix = numpy.identity(4)
    matrix[:3, :3] -= 2.0 * numpy.outer(normal, normal)
    matrix[:3, 3] = 2.0 * numpy.dot(point[:3], normal) * normal
    return matrix


def scale_matrix(factor: float, origin: Any = None, direction: Any = None) -> Any:
    """The matrix that scales about an origin, along a direction or in all."""
    matrix = numpy.identity(4)
    if direction is None:
        matrix[:3, :3] *= factor
    else:
        direction = unit_vector(direction[:3])
        matrix[:3, :3] -= (1.0 - factor) * numpy.outer(direction, direction)
    if origin is not None:
        origin = _view(origin[:3])
        matrix[:3, 3] = origin - numpy.dot(matrix[:3, :3], origin)
    return matrix


def shear_matrix(angle: float, direction: Any, point: Any, normal: Any) -> Any:
    """The matrix that shears along a direction in a plane."""
    normal, direction = unit_vector(normal[:3]), unit_vector(direction[:3])
    if abs(numpy.dot(normal, direction)) > 1e-6:
        raise ValueError("direction and normal vectors are not orthogonal")
    matrix = numpy.identity(4)
    matrix[:3, :3] += math.tan(angle) * numpy.outer(direction, normal)
    matrix[:3, 3] = -math.tan(angle) * numpy.dot(point[:3], normal) * direction
    return matrix


def inverse_matrix(matrix: Any) -> Any:
    """The matrix that undoes another."""
    return numpy.linalg.inv(matrix)


def concatenate_matrices(*matrices: Any) -> Any:
    """The product: the last is what happens first."""
    product = numpy.identity(4)
    for matrix in matrices:
        product = numpy.dot(product, matrix)
    return product


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Whether they do the same, as far as can be seen."""
    one, other = _copy(matrix0), _copy(matrix1)
    return bool(numpy.allclose(one / one[3, 3], other / other[3, 3]))


def compose_matrix(
    scale: Any = None, shear: Any = None, angles: Any = None, translate: Any = None, perspective: Any = None
) -> Any:
    """The matrix that scales, shears (x-y, x-z, y-z), rotates (about static x, y, z), moves, and projects, in this order."""
    matrix = numpy.identity(4)
    if perspective is not None:
        matrix[3, :] = perspective[:4]
    if translate is not None:
        matrix = numpy.dot(matrix, translation_matrix(translate))
    if angles is not None:
        matrix = numpy.dot(matrix, euler_matrix(angles[0], angles[1], angles[2]))
    if shear is not None:
        sheared = numpy.identity(4)
        sheared[0, 1], sheared[0, 2], sheared[1, 2] = shear[:3]
        matrix = numpy.dot(matrix, sheared)
    if scale is not None:
        matrix = numpy.dot(matrix, numpy.diag((scale[0], scale[1], scale[2], 1.0)))
    return matrix / matrix[3, 3]


def decompose_matrix(matrix: Any) -> Any:
    """Scale, shear, angles, translation and perspective, as `compose_matrix` takes them."""
    matrix = _copy(matrix)
    if abs(matrix[3, 3]) < _EPS:
        raise ValueError("M[3, 3] is zero")
    matrix /= matrix[3, 3]
    affine = matrix.copy()
    affine[3, :] = 0, 0, 0, 1
    if not numpy.linalg.det(affine):
        raise ValueError("Matrix is singular")
    perspective = numpy.dot(matrix[3, :], numpy.linalg.inv(affine))
    # The columns are a rotation times an upper triangle, which has the scales and shears.
    columns = [affine[:3, column].copy() for column in range(3)]
    scale, shear = numpy.zeros(3), [0.0, 0.0, 0.0]
    for at in range(3):
        for before in range(at):
            part = numpy.dot(columns[before], columns[at])
            columns[at] -= part * columns[before]
            shear[before + at - 1] = part
        scale[at] = vector_norm(columns[at])
        columns[at] /= scale[at]
    shear = [shear[0] / scale[1], shear[1] / scale[2], shear[2] / scale[2]]
    rotation = numpy.array(columns).T
    if numpy.linalg.det(rotation) < 0:
        scale, rotation = -scale, -rotation
    return scale, shear, list(rigid.euler(rotation)), affine[:3, 3].copy(), perspective


def superimposition_matrix(v0: Any, v1: Any, scaling: bool = False, usesvd: bool = True) -> Any:
    """The matrix that brings points (columns) as near to others as can be, by moving, rotating and perhaps scaling."""
    v0, v1 = _view(v0)[:3], _view(v1)[:3]
    if v0.shape != v1.shape or v0.shape[1] < 3:
        raise ValueError("Vector sets are of wrong shape or type.")
    middle0, middle1 = v0.mean(axis=1), v1.mean(axis=1)
    apart0, apart1 = v0 - middle0.reshape(3, 1), v1 - middle1.reshape(3, 1)
    u, _, vh = numpy.linalg.svd(numpy.dot(apart1, apart0.T))
    sign = 1.0 if numpy.linalg.det(numpy.dot(u, vh)) > 0 else -1.0
    inner = numpy.dot(u, numpy.dot(numpy.diag((1.0, 1.0, sign)), vh))
    if scaling:
        inner = inner * math.sqrt(numpy.sum(apart1 * apart1) / numpy.sum(apart0 * apart0))
    matrix = numpy.identity(4)
    matrix[:3, :3] = inner
    matrix[:3, 3] = middle1 - numpy.dot(inner, middle0)
    return matrix


# ── Euler's angles ──


def euler_matrix(ai: float, aj: float, ak: float, axes: Any = "sxyz") -> Any:
    """The matrix of three angles."""
    return quaternion_matrix(rigid.quaternion(ai, aj, ak, axes))


def euler_from_matrix(matrix: Any, axes: Any = "sxyz") -> tuple[float, float, float]:
    """Three angles of a matrix."""
    return rigid.euler(matrix, axes)


def euler_from_quaternion(quaternion: Any, axes: Any = "sxyz") -> tuple[float, float, float]:
    """Three angles of a quaternion."""
    return rigid.euler(rigid.rows(quaternion), axes)


# ── quaternions ──


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: Any = "sxyz") -> Any:
    """The quaternion of three angles."""
    return numpy.array(rigid.quaternion(ai, aj, ak, axes), dtype=numpy.float64)


def quaternion_about_axis(angle: float, axis: Any) -> Any:
    """The quaternion of an angle about an axis."""
    quaternion = numpy.zeros(4)
    quaternion[:3] = axis[:3]
    length = vector_norm(quaternion)
    if length > _EPS:
        quaternion *= math.sin(angle / 2.0) / length
    quaternion[3] = math.cos(angle / 2.0)
    return quaternion


def quaternion_matrix(quaternion: Any) -> Any:
    """The matrix of a quaternion."""
    matrix = numpy.identity(4)
    matrix[:3, :3] = rigid.rows(quaternion)
    return matrix


def quaternion_from_matrix(matrix: Any) -> Any:
    """The quaternion of a matrix."""
    matrix = _view(matrix)[:4, :4]
    return numpy.array(rigid.from_rows(matrix / matrix[3, 3]), dtype=numpy.float64)


def quaternion_multiply(quaternion1: Any, quaternion0: Any) -> Any:
    """The second rotation, and then the first."""
    return numpy.array(rigid.multiply(quaternion1, quaternion0), dtype=numpy.float64)


def quaternion_conjugate(quaternion: Any) -> Any:
    """The quaternion about the opposite axis."""
    return numpy.array(rigid.conjugate(quaternion), dtype=numpy.float64)


def quaternion_inverse(quaternion: Any) -> Any:
    """The rotation back."""
    return quaternion_conjugate(quaternion) / numpy.dot(quaternion, quaternion)


def quaternion_slerp(quat0: Any, quat1: Any, fraction: float, spin: int = 0, shortestpath: bool = True) -> Any:
    """The rotation so far on the way from one to the other, with so many half turns more."""
    q0, q1 = unit_vector(quat0[:4]), unit_vector(quat1[:4])
    if fraction in (0.0, 1.0):
        return q1 if fraction else q0
    inner = numpy.dot(q0, q1)
    if abs(abs(inner) - 1.0) < _EPS:
        return q0
    if shortestpath and inner < 0.0:
        inner, q1 = -inner, -q1
    angle = math.acos(inner) + spin * math.pi
    if abs(angle) < _EPS:
        return q0
    return (math.sin((1.0 - fraction) * angle) * q0 + math.sin(fraction * angle) * q1) / math.sin(angle)


def random_quaternion(rand: Any = None) -> Any:
    """A random rotation; `rand` has the three random numbers of 0..1 that it takes."""
    a, b, c = numpy.random.rand(3) if rand is None else rand
    one, other = math.sqrt(1.0 - a), math.sqrt(a)
    b, c = 2.0 * math.pi * b, 2.0 * math.pi * c
    return numpy.array((math.sin(b) * one, math.cos(b) * one, math.sin(c) * other, math.cos(c) * other))


def random_rotation_matrix(rand: Any = None) -> Any:
    """The matrix of a random rotation."""
    return quaternion_matrix(random_quaternion(rand))


_MISSING = (
    "reflection_from_matrix scale_from_matrix projection_matrix projection_from_matrix clip_matrix shear_from_matrix"
    " orthogonalization_matrix Arcball arcball_map_to_sphere arcball_constrain_to_axis arcball_nearest_axis"
).split()


def __getattr__(name: str) -> Any:
    if name not in _MISSING:
        raise AttributeError("module 'tf.transformations' has no attribute %r" % name)

    def missing(*args: Any, **kwargs: Any) -> Any:
        raise NotImplementedError(
            "tf.transformations.%s is not there in hrdsl: take it from the package `transforms3d`, or compute it with numpy"
            % name
        )

    return missing
