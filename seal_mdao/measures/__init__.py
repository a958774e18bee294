from seal_mdao.compilation import prepare_kernels

prepare_kernels()
