"""Gymnasium's Hopper-v4 in compiled code, with the bits of MuJoCo 4.0.0.

`environment` is the environment. The rest is its physics: what MuJoCo computes for this one body
(`model`), rewritten from MuJoCo's source (Apache License 2.0, Copyright DeepMind Technologies
Limited). `runge_kutta` takes a step, four times through `dynamics` (the acceleration without
constraints), `constraints` and `newton` (the acceleration under them). `check` compares steps with
the library's before any is used.

The hopper moves in a plane, and MuJoCo computes in three dimensions. Here every term that is zero
in each pose is left out, which changes no bit of a sum, and all others keep MuJoCo's order. So
a rotation is a quaternion (w, y), a point is (x, z), and a spatial vector has three numbers:
rotation about y, then x and z. Docstrings name the functions of MuJoCo that a kernel stands for.
"""
