"""Isotropic rubbers and foams in plane strain: strain energy W(T, J) and its derivatives."""

from seal_mdao.compilation import prepare_kernels

prepare_kernels()
