"""Axes without the default ticks, which matplotlib makes and then discards."""

from __future__ import annotations

from matplotlib.axes import Axes


class BareAxes(Axes):
    """Axes that make a tick when one is asked for.

    Matplotlib makes four with each axes, to be told of the grid and of where to clip, which is half of the time that
    axes take; of a finished picture `fem_seal.output.pictures.style.svg` draws them all at once.
    """

    def clear(self) -> None:
        """Empty axes."""
        for axis in (self.xaxis, self.yaxis):
            # or the next line would be forgotten
            axis.reset_ticks = _nothing  # type: ignore[method-assign]
            axis.majorTicks, axis.minorTicks = [], []
        super().clear()
        for spine in self.spines.values():
            # which the first tick would have asked for
            spine.get_spine_transform()


def _nothing() -> None:
    pass
