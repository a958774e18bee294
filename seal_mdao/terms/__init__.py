"""Terms of equilibrium: the contract, and terms that act at single points."""

from seal_mdao.compilation import prepare_kernels

prepare_kernels()
