"""The Bayesian generative model of cross-situational learning, and its samplers."""

from model.data import Channel, Prior, Trials
from model.fits import load, save
from model.fitting import Fit, fit
from model.frames import METHODS, Method
from model.state import Settings, State

__all__ = [
    "METHODS",
    "Channel",
    "Fit",
    "Method",
    "Prior",
    "Settings",
    "State",
    "Trials",
    "fit",
    "load",
    "save",
]
