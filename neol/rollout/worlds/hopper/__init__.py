"""Gymnasium's Hopper-v4 in compiled code, with the bits of MuJoCo 4.0.0.

`environment` is the environment. The other modules are its physics: MuJoCo's computation for this
one body (`model`), rewritten from MuJoCo's source (Apache License 2.0, Copyright DeepMind
Technologies Limited). `runge_kutta` takes a step, which evaluates four times `dynamics` (the
acceleration without constraints), `constraints` and `newton` (the acceleration under constraints).
`check` compares steps with the library's before any is used.

The hopper moves in a plane, while MuJoCo computes in three dimensions. Here terms that are zero in
every pose are omitted, which changes no bit of a sum; all others keep MuJoCo's order. So a rotation
is a quaternion (w, y), a point is (x, z), and a spatial vector has three numbers: rotation about y,
then x and z. Docstrings name the MuJoCo functions that a kernel replaces.
"""

from neol.rollout.environment import import_mujoco

import_mujoco()
