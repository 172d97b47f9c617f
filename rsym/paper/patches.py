"""The figures of parametric surfaces as recipes."""

from __future__ import annotations

from rsym.paper import coons, fitting, hull, joints, network, tori
from rsym.paper.drawing import Recipe

SURFACES: tuple[Recipe, ...] = (
    Recipe(
        "paraboloid",
        "A bicubic Coons patch beside the plane of its corners",
        "",
        coons.draw_paraboloid,
        equations=coons.EQUATIONS,
    ),
    Recipe("twists", "What the twists at the corners do", "", coons.draw_twists),
    Recipe("torus", "The torus from exact patches", "", tori.draw_torus, equations=tori.EQUATIONS),
    Recipe("joints", "Two patches that meet, joined G1, and joined G2", "", joints.draw_joints),
    Recipe("hull", "A hull through sections", "", hull.draw_hull),
    Recipe("network", "A surface through a network of curves", "", network.draw_network, equations=(network.EQUATION,)),
    Recipe("fitting", "A B-spline surface with fewer vertices than data", "", fitting.draw_fitting),
)
