"""Small SDFormat models, each with something that a reader can get wrong, and Drake 1.51.1's numbers for them.

Drake reads SDFormat by libsdformat, the format's own library. Gravity is 9.81 m/s^2 on both sides.
"""

from __future__ import annotations

from typing import NamedTuple

INERTIAL = (
    "<inertial><pose>0.1 -0.05 0.2 0.3 0.1 -0.2</pose><mass>{mass}</mass><inertia>"
    "<ixx>0.2</ixx><iyy>0.3</iyy><izz>0.25</izz><ixy>0.01</ixy><ixz>-0.02</ixz><iyz>0.03</iyz></inertia></inertial>"
)


def link(name: str, pose: str, mass: float) -> str:
    """A link with an inertia that has no symmetry."""
    return f'<link name="{name}">{pose}{INERTIAL.format(mass=mass)}</link>'


def document(body: str, version: str = "1.11") -> str:
    """A file of one model."""
    return f'<sdf version="{version}"><model name="arm">{body}</model></sdf>'


class Drake(NamedTuple):
    """What Drake says.

    Attributes:
        text: The file.
        coordinates: Names of the coordinates, in Drake's order.
        q: Coordinates [rad or m].
        v: Speeds [rad/s or m/s].
        M: Lower triangle of the mass matrix, row by row.
        h: Coriolis forces and weight.
    """

    text: str
    coordinates: tuple[str, ...]
    q: tuple[float, ...]
    v: tuple[float, ...]
    M: tuple[float, ...]
    h: tuple[float, ...]


MODELS: dict[str, Drake] = {
    "frames that refer to each other": Drake(
        document(
            "<pose>0.3 0.2 0.1 0.2 0.1 0.4</pose>"
            + link("a", "<pose>0.1 0.2 0.3 0.1 0.2 0.3</pose>", 2)
            + link("b", '<pose relative_to="a">0.5 0 0.1 0 0.4 0</pose>', 1)
            + link("c", '<pose relative_to="f">0.1 0.1 0 0 0 0.3</pose>', 1.5)
            + '<frame name="f" attached_to="b"><pose relative_to="j2">0.2 0 0 0.5 0 0</pose></frame>'
            '<frame name="tip" attached_to="c"><pose>0.4 0 0 0 1 0</pose></frame>'
            '<joint name="j1" type="revolute"><parent>world</parent><child>a</child>'
            '<axis><xyz expressed_in="__model__">0.6 0 0.8</xyz></axis></joint>'
            '<joint name="j2" type="revolute"><pose>0.05 0.1 0.15 0.3 0 0</pose><parent>a</parent><child>b</child>'
            "<axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>7</effort></limit></axis></joint>"
            '<joint name="j3" type="prismatic"><pose relative_to="tip">0.05 0.1 0.15 0.3 0 0</pose><parent>f</parent>'
            '<child>c</child><axis><xyz expressed_in="a">1 2 0</xyz></axis></joint>',
            "1.7",
        ),
        ("j1", "j2", "j3"),
        (
            0.1257302210933933,
            -0.1321048632913019,
            0.6404226504432821,
        ),
        (
            0.10490011715303971,
            -0.535669373161111,
            0.36159505490948474,
        ),
        (
            3.516037590872475,
            0.17133766871760353,
            1.2668296066348714,
            1.089423532368781,
            0.19295480929683126,
            1.5000000000000002,
        ),
        (
            14.293418678344631,
            -8.624996206083933,
            4.111550964104327,
        ),
    ),
    "axes of version 1.6": Drake(
        document(
            link("a", "<pose>0.1 0.2 0.3 0.1 0.2 0.3</pose>", 2)
            + link("b", "<pose>0.5 0 0.1 0 0.4 0</pose>", 1)
            + '<joint name="j1" type="revolute"><parent>world</parent><child>a</child>'
            "<axis><xyz>0.6 0 0.8</xyz><use_parent_model_frame>true</use_parent_model_frame></axis></joint>"
            '<joint name="j2" type="continuous"><pose>0.05 0.1 0.15 0.3 0 0</pose><parent>a</parent><child>b</child>'
            "<axis><xyz>0 1 0</xyz></axis></joint>",
            "1.6",
        ),
        ("j1", "j2"),
        (
            0.1257302210933933,
            -0.1321048632913019,
        ),
        (
            0.6404226504432821,
            0.10490011715303971,
        ),
        (
            0.810774488777233,
            0.15535332969955354,
            0.30100876058163084,
        ),
        (
            -1.3896386403394723,
            -0.7099204662570111,
        ),
    ),
    "kinds of joints": Drake(
        document(
            link("a", "<pose>0.1 0.2 0.3 0.1 0.2 0.3</pose>", 2)
            + link("b", '<pose relative_to="a">0.5 0 0.1 0 0.4 0</pose>', 1)
            + link("c", '<pose relative_to="b">0.5 0 0.1 0 0.4 0</pose>', 1)
            + link("d", '<pose relative_to="c">0.5 0 0.1 0 0.4 0</pose>', 1)
            + '<joint name="weld" type="fixed"><parent>world</parent><child>a</child></joint>'
            '<joint name="s" type="screw"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis>'
            "<screw_thread_pitch>0.3</screw_thread_pitch></joint>"
            '<joint name="u" type="universal"><pose>0 0.1 0 0.2 0 0</pose><parent>b</parent><child>c</child>'
            "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>"
            '<joint name="e" type="revolute"><pose>0 0.1 0 0.2 0 0</pose><parent>c</parent><child>d</child>'
            "<axis><xyz>1 0 0</xyz></axis></joint>",
            "1.9",
        ),
        ("s", "u.angle1", "u.angle2", "e"),
        (
            0.1257302210933933,
            -0.1321048632913019,
            0.6404226504432821,
            0.10490011715303971,
        ),
        (
            -0.535669373161111,
            0.36159505490948474,
            1.3040000451301372,
            0.9470809631292422,
        ),
        (
            2.3978626463547523,
            -0.022728111437401975,
            0.5480203596293629,
            0.010856023725925729,
            0.20644069221384842,
            1.1198385995811155,
            -0.4271583360669059,
            0.07111311424616353,
            0.07772312690240755,
            0.27070966637510935,
        ),
        (
            5.84755010017716,
            -0.49101852458698003,
            -4.092891358899265,
            0.14604222304096126,
        ),
    ),
    "nested model": Drake(
        document(
            '<model name="sub"><pose relative_to="a">0.4 0.1 0 0 0.2 0</pose>'
            + link("b", "<pose>0.1 0 0 0 0 0.3</pose>", 1)
            + link("c", '<pose relative_to="b">0.3 0 0 0 0 0.3</pose>', 1)
            + '<joint name="jj" type="revolute"><parent>b</parent><child>c</child>'
            '<axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint></model>'
            + link("a", '<pose degrees="true">0.1 0.2 0.3 10 20 30</pose>', 2)
            + '<joint name="j1" type="revolute"><parent>world</parent><child>a</child>'
            "<axis><xyz>0.6 0 0.8</xyz></axis></joint>"
            '<joint name="j2" type="revolute"><pose relative_to="sub">0.1 0 0.1 0 0 0</pose><parent>a</parent>'
            "<child>sub::b</child><axis><xyz>0 0 1</xyz></axis></joint>"
        ),
        ("j1", "j2", "sub::jj"),
        (
            0.1257302210933933,
            -0.1321048632913019,
            0.6404226504432821,
        ),
        (
            0.10490011715303971,
            -0.535669373161111,
            0.36159505490948474,
        ),
        (
            1.676819083273227,
            0.9648332468777389,
            0.8096398337754525,
            0.014921127642254811,
            0.024296040569032444,
            0.33247238887836694,
        ),
        (
            3.890018423929693,
            1.6247657550230015,
            -2.1676489860108337,
        ),
    ),
}
