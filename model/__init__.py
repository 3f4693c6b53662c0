"""The Bayesian generative model of cross-situational learning, and its samplers.

Importing the package does not load Numba: what is compiled is imported where it is called.
"""

from model.data import Channel, Trials
from model.fits import Fit, History, load, save
from model.fitting import fit
from model.methods import METHODS, Method
from model.prior import Prior
from model.problem import Problem
from model.samplers import SAMPLERS, Blocked, Collapsed, Sampler
from model.state import State

__all__ = [
    "METHODS",
    "SAMPLERS",
    "Blocked",
    "Channel",
    "Collapsed",
    "Fit",
    "History",
    "Method",
    "Prior",
    "Problem",
    "Sampler",
    "State",
    "Trials",
    "fit",
    "load",
    "save",
]
