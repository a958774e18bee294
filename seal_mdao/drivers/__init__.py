"""OpenMDAO drivers that reach the optimum although an analysis may fail on the way."""

from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.slsqp_driver import ResilientSLSQPDriver

__all__ = ["IpoptDriver", "ResilientSLSQPDriver"]
