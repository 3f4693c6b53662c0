"""The Bayesian generative model of cross-situational learning, and its samplers."""

from model.data import Channel, Trials
from model.fits import Fit, History, load, save
from model.fitting import fit
from model.frames import METHODS, Method
from model.prior import Prior
from model.state import Settings, State

__all__ = [
    "METHODS",
    "Channel",
    "Fit",
    "History",
    "Method",
    "Prior",
    "Settings",
    "State",
    "Trials",
    "fit",
    "load",
    "save",
]
