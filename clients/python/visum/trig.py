"""Sines and arc tangents with the same bits on every machine, for controllers whose runs must repeat bit for bit.

The C library's functions, which `math` and numpy use, have other bits on other processors. These are the daemon's own
(protocol/config/trig.cc), operation for operation, accurate to about 1 unit in the last place. All but arc_tangent
also take a numpy array. Angles are in rad.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np

    Number = TypeVar("Number", float, np.ndarray)

_MOST = 1e6
_TWO_BY_PI = 6.36619772367581382433e-01
_HALF_PI_HIGH = 1.57079632673412561417e+00  # 33 bits, so that n times it is exact
_HALF_PI_LOW = 6.07710050650619224932e-11
_ROUND = 6755399441055744.0  # 1.5 * 2**52: adding it rounds to a whole number

_S0, _S1, _S2, _S3, _S4, _S5 = (-1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
                                2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10)
_C0, _C1, _C2, _C3, _C4, _C5 = (4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
                                -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11)

_ATAN_HIGH = (4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01, 1.57079632679489655800e+00)
_ATAN_LOW = (2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17, 6.12323399573676603587e-17)
_A = (3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01, -1.11111104054623557880e-01,
      9.09088713343650656196e-02, -7.69187620504482999495e-02, 6.66107313738753120669e-02, -5.83357013379057348645e-02,
      4.97687799461593236017e-02, -3.65315727442169155270e-02, 1.62858201153657823623e-02)


def _near_zero(x: Number) -> tuple[Number, Number]:
    """Sine and cosine for |x| <= pi/4."""
    z = x * x
    s = _S0 + z * (_S1 + z * (_S2 + z * (_S3 + z * (_S4 + z * _S5))))
    c = _C0 + z * (_C1 + z * (_C2 + z * (_C3 + z * (_C4 + z * _C5))))
    return x + x * z * s, 1.0 - (0.5 * z - z * z * c)


def sin_cos(x: Number) -> tuple[Number, Number]:
    """Sine and cosine for |x| up to 1e6; NaN beyond it."""
    if not isinstance(x, (int, float)):
        return _sin_cos_of_array(x)
    if not abs(x) <= _MOST:
        return math.nan, math.nan
    n = (x * _TWO_BY_PI + _ROUND) - _ROUND
    s, c = _near_zero((x - n * _HALF_PI_HIGH) - n * _HALF_PI_LOW)
    quarter = int(n) & 3
    if quarter & 1:
        s, c = c, -s
    return (-s, -c) if quarter & 2 else (s, c)


def _sin_cos_of_array(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    import numpy as np

    x = np.where(np.abs(x) <= _MOST, x, np.nan)
    n = (x * _TWO_BY_PI + _ROUND) - _ROUND
    s, c = _near_zero((x - n * _HALF_PI_HIGH) - n * _HALF_PI_LOW)
    quarter = np.where(np.isnan(n), 0.0, n).astype(np.int64) & 3
    return np.choose(quarter, [s, c, -s, -c]), np.choose(quarter, [c, -s, -c, s])


def sine(x: Number) -> Number:
    return sin_cos(x)[0]


def cosine(x: Number) -> Number:
    return sin_cos(x)[1]


def tangent(x: Number) -> Number:
    s, c = sin_cos(x)
    return s / c


def hypotenuse(x: Number, y: Number) -> Number:
    """sqrt(x*x + y*y), for lengths far from the limits of a double."""
    if isinstance(x, (int, float)):
        return math.sqrt(x * x + y * y)
    import numpy as np

    return np.sqrt(x * x + y * y)


def _atan_rest(x: float) -> float:
    """x - atan(x) for |x| <= 7/16."""
    z = x * x
    w = z * z
    even = z * (_A[0] + w * (_A[2] + w * (_A[4] + w * (_A[6] + w * (_A[8] + w * _A[10])))))
    odd = w * (_A[1] + w * (_A[3] + w * (_A[5] + w * (_A[7] + w * _A[9]))))
    return x * (even + odd)


def _atan_positive(y: float, x: float) -> float:
    """atan(y/x) for y, x >= 0, not both 0."""
    if y < 0.4375 * x:
        t = y / x
        return t - _atan_rest(t)
    part, above, below = 3, -x, y
    if y < 0.6875 * x:
        part, above, below = 0, 2.0 * y - x, 2.0 * x + y
    elif y < 1.1875 * x:
        part, above, below = 1, y - x, y + x
    elif y < 2.4375 * x:
        part, above, below = 2, y - 1.5 * x, x + 1.5 * y
    t = above / below
    return _ATAN_HIGH[part] - ((_atan_rest(t) - _ATAN_LOW[part]) - t)


def arc_tangent(y: float, x: float) -> float:
    """As math.atan2; 0 for two zeros."""
    if y == 0.0 and x >= 0.0:
        return 0.0
    angle = _atan_positive(abs(y), abs(x))
    turned = math.pi - angle if x < 0.0 else angle
    return -turned if y < 0.0 else turned
