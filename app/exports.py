"""A run as a file: rows as CSV or NPZ, curves as a picture, the moving arm as a page of its own."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robot.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

FRAME_RATE = 30.0
"""Frames of a saved replay in a simulated second."""

MOST_FRAMES = 900
"""Frames of a saved replay at most; a longer run gets fewer a second."""


def csv(run: Run) -> bytes:
    """Return the run as CSV, one row a control step, with 17 digits; the header names coordinates and actuators."""
    arrays = _arrays(run)
    names = ["t", *(f"{kind}_{name}" for kind in arrays for name in run.arm.coordinates), *run.arm.actuators]
    values = np.hstack([run.t[:, np.newaxis], *arrays.values(), run.forces])
    text = io.StringIO()
    np.savetxt(text, values, fmt="%.17g", delimiter=",", header=",".join(names), comments="")
    return text.getvalue().encode()


def npz(run: Run) -> bytes:
    """Return the run as a compressed NumPy archive."""
    data = io.BytesIO()
    np.savez_compressed(
        data,
        t=run.t,
        forces=run.forces,
        activity=run.activity,
        clamped=run.clamped,
        undefined=run.undefined,
        coordinates=np.array(run.arm.coordinates),
        actuators=np.array(run.arm.actuators),
        allow_pickle=False,
        **_arrays(run),
    )
    return data.getvalue()


def picture(run: Run, title: str, others: Sequence[tuple[str, str, Run]] = (), *, kind: str = "png") -> bytes:
    """Return positions, references, fuzzy outputs and forces over time as a picture.

    Args:
        run: The run.
        title: Stands above.
        others: Runs to compare with, dashed: name, colour, run.
        kind: A format that matplotlib writes: png, svg, pdf ...

    Raises:
        ValueError: A format that it does not.
    """
    from matplotlib.figure import Figure  # here, because starting must not wait for it

    figure = Figure(figsize=(9, 10.5), layout="constrained")
    lengths, angles, outputs, forces = figure.subplots(4, 1, sharex=True)
    n = run.arm.n_modules
    for axes, first, factor, unit in ((lengths, 0, 1e3, "length / mm"), (angles, n, np.rad2deg(1.0), "angle / °")):
        for place in range(first, first + n):
            (line,) = axes.plot(run.t, factor * run.q[:, place], label=run.arm.coordinates[place])
            axes.plot(run.t, factor * run.reference[:, place], color=line.get_color(), linestyle=":", linewidth=1)
            for name, color, other in others:
                label = name if place == first else None
                axes.plot(other.t, factor * other.q[:, place], color=color, linestyle="--", linewidth=1, label=label)
        axes.set_ylabel(unit)
    _draw(outputs, run.t, run.output, run.arm.coordinates, "fuzzy output T")
    _draw(forces, run.t, run.forces, run.arm.actuators, "actuator force / N")
    forces.set_xlabel("time / s")
    for axes in (lengths, angles, outputs, forces):
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small", frameon=False)
        axes.grid(alpha=0.3)
    lengths.set_title(f"{title} (targets dotted)")
    data = io.BytesIO()
    figure.savefig(data, dpi=120, format=kind)
    return data.getvalue()


def replay_html(run: Run) -> str:
    """Return the moving arm as one page that needs nothing else and has a time slider of its own.

    The scene is recorded on a server of its own, to which nobody is let in; the one that people look at stays as it is.
    """
    import secrets

    from app.guard import start_server
    from app.runner.frames import frame_of
    from app.scene.arm import ArmView
    from app.scene.cameras import CAMERAS
    from app.scene.scene import light

    server = start_server(port=0, token=secrets.token_urlsafe(32))
    try:
        light(server.scene)
        server.initial_camera.position, server.initial_camera.look_at = CAMERAS["arm"]
        arm = ArmView(server.scene)
        rate = min(FRAME_RATE, MOST_FRAMES / max(float(run.t[-1]), 1.0 / FRAME_RATE))
        arm.show(frame_of(run, 0.0))
        serializer = server.get_scene_serializer()
        for time in np.arange(0.0, float(run.t[-1]) + 0.5 / rate, 1.0 / rate):
            arm.show(frame_of(run, float(time)))
            serializer.insert_sleep(1.0 / rate)
        return serializer.as_html(dark_mode=True)
    finally:
        server.stop()


def _arrays(run: Run) -> dict[str, Array]:
    arrays = {"q": run.q, "dq": run.dq, "reference": run.reference, "control": run.control}
    return arrays | {
        "disturbance": run.disturbance,
        "e": run.inputs[:, :, 0],
        "de": run.inputs[:, :, 1],
        "T": run.output,
    }


def _draw(axes: Axes, t: Array, values: Array, names: Iterable[str], label: str) -> None:
    for place, name in enumerate(names):
        axes.plot(t, values[:, place], label=name, linewidth=1)
    axes.set_ylabel(label)
