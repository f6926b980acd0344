"""What computes a run's plans: the processor, or a GPU. One choice, which changes no plan."""

from typing import Protocol, Self, TypeVar, runtime_checkable

from gapath.errors import InputError, require

CPU, CUDA = "cpu", "cuda"

Component = TypeVar("Component")


@runtime_checkable
class Portable(Protocol):
    """A task or planner that something else than the processor can compute, with the same plans."""

    @property
    def device(self) -> str:
        """What computes it: `CPU`, or the name of a GPU."""

    def on(self, device: str) -> Self:
        """Give a copy that is computed by another device.

        Parameters
        ----------
        device : str
            CUDA.

        Returns
        -------
        Portable
            A copy with the same settings.

        Raises
        ------
        InputError
            If it cannot be, or if a GPU or what drives it is missing.
        """


def on_device(component: Component, device: str) -> Component:
    """Give the same component, computed by a device.

    Parameters
    ----------
    component : Task or Planner
        Any.
    device : str
        CPU or CUDA.

    Returns
    -------
    Task or Planner
        A copy; the component itself for the processor.

    Raises
    ------
    InputError
        For an unknown device, one that is missing, or one that cannot compute the component.
    """
    require(device in (CPU, CUDA), "device", device, f"{CPU} or {CUDA}")
    if device == CPU:
        return component
    name = type(component).__module__.rpartition(".")[2]
    if not isinstance(component, Portable):
        raise InputError("device", device, f"{CPU}, which alone computes {name}")
    return component.on(device)


def device_of(component: object) -> str:
    """Say what computes a task or planner: `CPU`, or the name of a GPU."""
    return component.device if isinstance(component, Portable) else CPU
