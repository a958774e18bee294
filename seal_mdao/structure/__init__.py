"""The structural form a: hyperelastic bodies, internal force, its rates and seeds."""

from seal_mdao.compilation import prepare_kernels

prepare_kernels()
