"""Background work: the live simulation, paced, and the whole scenario again after every change.

Nothing here touches the state. Two threads compute; what they find goes out as events (:meth:`app.store.Store.post`)
or waits as the latest sample for the 30 Hz stream. Both threads run kernels that release the interpreter lock.
"""

from app.runner.frames import TICKS_PER_SECOND, Frame, Ghost, sample_at
from app.runner.live import LiveSimulation, Moment
from app.runner.previews import Previews, result_of
from app.runner.runner import Runner

__all__ = [
    "TICKS_PER_SECOND",
    "Frame",
    "Ghost",
    "LiveSimulation",
    "Moment",
    "Previews",
    "Runner",
    "result_of",
    "sample_at",
]
