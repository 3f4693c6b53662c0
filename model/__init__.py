"""The Bayesian generative model of cross-situational learning, and its samplers.

Importing the package does not load Numba: what is compiled is imported where it is called.
"""

from model.data import Channel, Trials
from model.fits import Fit, load, save
from model.fitting import fit
from model.history import Chains, History
from model.methods import METHODS, Method
from model.prior import Prior
from model.problem import Problem
from model.samplers import SAMPLERS, Blocked, Collapsed, Mixing, Sampler
from model.state import State
from model.summaries import Summary

__all__ = [
    "METHODS",
    "SAMPLERS",
    "Blocked",
    "Chains",
    "Channel",
    "Collapsed",
    "Fit",
    "History",
    "Method",
    "Mixing",
    "Prior",
    "Problem",
    "Sampler",
    "State",
    "Summary",
    "Trials",
    "fit",
    "load",
    "save",
]
