"""The page of a replay: viser's, with the motion's time, its coordinates, a scale bar and the colours of its reader."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.page.page_head import VISER_TITLE, fragment, page_head
from symofros.studio.viewer.playing.signals import Signal
from symofros.studio.viewer.render.camera import LONGEST, UNITS, Camera
from symofros.studio.viewer.replays.packing import packed

# Of viser's environment, which alone is too weak before a dark ground.
_DARK_INTENSITY = 3.0
_RECORDING = re.compile(r'window\.__VISER_EMBED_DATA__="([^"]*)";')
_PROGRAM, _HELD = "<script data-p=", '<script type="text/plain" id="held" data-p='
_LIGHT = "darkMode:false"
_ASKED = 'darkMode:matchMedia("(prefers-color-scheme: dark)").matches'


def replay_page(
    page: str,
    title: str,
    camera: Camera,
    t: Array,
    period: float,
    remark: str,
    q: Array,
    names: Sequence[str],
    units: Sequence[str],
    signals: Sequence[Signal] = (),
    onward: Mapping[str, Any] | None = None,
    legend: str = "",
    tolerance: float = 0.0,
) -> str:
    """A recording's page with a title and the controls of a replay.

    Args:
        page: Page of viser, with the recording in it.
        title: Title of the page, which its tab shows.
        camera: Camera that the page begins with.
        t: Times of the pictures (n) [s].
        period: Time from picture to picture, as they are played [s].
        remark: Words after the time.
        q: Coordinates in the pictures (n, nq).
        names: Their names (nq).
        units: Their units (nq); "" where there is none.
        signals: Signals of the motion, to be plotted.
        onward: What simulates on (`onward.onward`), where the page is to do that.
        legend: What tells ghosts apart, as HTML.
        tolerance: How far shapes are from those of their files, which the page tells [m]; 0: not at all.
    """
    forward = camera.axes[2]
    given: dict[str, Any] = {
        "t": [float(f"{time:.9g}") for time in t],
        "period": period,
        "remark": remark,
        "q": base64.b64encode(np.ascontiguousarray(q, dtype="<f4").tobytes()).decode(),
        "names": list(names),
        "unit_of": list(units),
        "distance": float(np.linalg.norm(camera.target - camera.position)),
        # What no turn of the world, which viser makes, changes of where the camera is.
        "from_origin": float(np.linalg.norm(camera.position)),
        "along": float(camera.position @ forward),
        "longest": LONGEST,
        "units": UNITS,
        "dark_intensity": _DARK_INTENSITY,
        "signals": _packed(signals, t, names),
        "onward": onward,
        "legend": legend,
        "tolerance": tolerance,
    }
    # No "<" of a name may end the script.
    data = json.dumps(given).replace("<", "\\u003c")
    head = page_head(title) + fragment("replay.html", "replays").replace("/*given*/", data)
    return page.replace(VISER_TITLE, head, 1).replace(_LIGHT, _ASKED, 1)


def _packed(signals: Sequence[Signal], t: Array, names: Sequence[str]) -> list[dict[str, Any]]:
    """Signals at the times of the pictures (n), in single precision; those of coordinates by their indices only."""
    places, packed = {name: i for i, name in enumerate(names)}, []
    for signal in signals:
        if all(curve in places for curve in signal.curves):
            packed.append({"name": signal.name, "of": [places[curve] for curve in signal.curves]})
        else:
            values = np.ascontiguousarray(signal.at(t).T, dtype="<f4").tobytes()
            curves, data = list(signal.curves), base64.b64encode(values).decode()
            packed.append({"name": signal.name, "curves": curves, "values": data})
    return packed


def lighter(page: str, step: float) -> str:
    """A page of viser with the recording in it packed; viser's program waits for it to be unpacked.

    Args:
        page: Page of viser, with the recording in it as it writes it.
        step: Step of positions [m].
    """
    recording = _RECORDING.search(page)
    if recording is None or _PROGRAM not in page:
        return page
    data = base64.b64encode(packed(base64.b64decode(recording[1]), step)).decode()
    script = fragment("unpack.js", "replays").replace("/*packed*/", data)
    page = page.replace(recording[0], "", 1).replace(_PROGRAM, _HELD, 1)
    return page.replace("</head>", f"<script>{script}</script></head>", 1)
