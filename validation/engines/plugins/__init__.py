"""One module or folder an engine, each with its PLUGIN; none imports its engine before a model is built."""

from __future__ import annotations

from ..interface import EnginePlugin
from . import (
    adam,
    basilisk,
    casadi,
    dart,
    drake,
    dynibo,
    exudyn,
    frax,
    idyntree,
    mjx,
    mujoco,
    mujoco_warp,
    newton,
    pinocchio,
    pybullet,
    pykdl,
    roboticstoolbox,
    sapien,
    spatialmath,
    symofros,
    trimesh,
    yourdfpy,
)
from .loops import exudyn as exudyn_joints
from .turns import mink

_MODULES = (
    pinocchio,
    mujoco,
    exudyn,
    exudyn_joints,
    adam,
    basilisk,
    casadi,
    dart,
    drake,
    dynibo,
    frax,
    idyntree,
    mjx,
    mujoco_warp,
    newton,
    pybullet,
    pykdl,
    roboticstoolbox,
    sapien,
    spatialmath,
    symofros,
    trimesh,
    mink,
    yourdfpy,
)
OWN: dict[str, EnginePlugin] = {module.PLUGIN.name: module.PLUGIN for module in _MODULES}
