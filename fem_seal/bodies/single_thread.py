"""Small dense problems on one BLAS thread."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
T = TypeVar("T")


def single_threaded(function: Callable[P, T]) -> Callable[P, T]:
    """Let a function have one BLAS thread.

    A contact has a few hundred unknowns: threads gain nothing there, and on a busy machine their waiting for each
    other makes a solve a hundred times slower.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        controller = _controller()
        if all(one.num_threads == 1 for one in controller.lib_controllers if one.user_api == "blas"):
            return function(*args, **kwargs)
        with controller.limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


@cache
def _controller() -> ThreadpoolController:
    """Looks once for the BLAS libraries of the process; numpy and scipy bring one each."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
