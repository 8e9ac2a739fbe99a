"""What can go wrong, grouped by whose turn it is to act.

    SatAoiError
    ├── InputError            an option or a settings file is wrong        (ValueError)
    │   └── RobotError        the robot contradicts itself
    ├── DrawingError          the drawing cannot be used as it is          (ValueError)
    │   ├── UnreadableError   it is not the kind of file its name says
    │   ├── UnitError         its unit of length is not known
    │   └── EmptyPlanError    it holds nothing to work on
    ├── StartError            the robot cannot be set down                 (LookupError)
    │   ├── StartBlockedError   at the place that was asked for
    │   ├── NothingFreeError    anywhere on the floor
    │   └── NoRouteError        so that it could trowel a point
    └── LimitError            a stated limit was reached                   (RuntimeError)

Each message says what, where, how much and what to do; the same facts are attributes.
"""


class SatAoiError(Exception):
    """Base of every error this program raises on purpose."""


class InputError(SatAoiError, ValueError):
    """An option or a settings file is wrong."""


class RobotError(InputError):
    """The robot's measures contradict each other.

    Attributes:
        measure: Name of the measure at fault, as in the robot's file.
    """

    def __init__(self, message: str, *, measure: str) -> None:
        super().__init__(message)
        self.measure = measure


class DrawingError(SatAoiError, ValueError):
    """The drawing cannot be used as it is.

    Attributes:
        layer: Layer at fault, or an empty string.
        handle: Handle or GlobalId of the entity at fault, or an empty string.
        at_mm: Where, in the drawing's axes in millimetres, or None.
    """

    def __init__(
        self,
        message: str,
        *,
        layer: str = "",
        handle: str = "",
        at_mm: tuple[float, float] | None = None,
    ) -> None:
        super().__init__(message)
        self.layer = layer
        self.handle = handle
        self.at_mm = at_mm


class UnreadableError(DrawingError):
    """The file is missing, damaged, or not of the kind its name says."""


class UnitError(DrawingError):
    """The drawing's unit of length is not known."""


class EmptyPlanError(DrawingError):
    """The drawing holds no floor, or nothing a floor could be inferred from."""


class StartError(SatAoiError, LookupError):
    """The robot cannot be set down."""


class StartBlockedError(StartError):
    """No pose is free at the start that was asked for.

    Attributes:
        at_mm: The start, in the drawing's axes in millimetres.
        handle: Handle of the obstacle in the way, or an empty string for the edge of the floor.
        layer: Its layer.
        nearest_mm: The nearest node with a free pose, in the drawing's axes, or None.
    """

    def __init__(
        self,
        message: str,
        *,
        at_mm: tuple[float, float],
        handle: str,
        layer: str,
        nearest_mm: tuple[float, float] | None,
    ) -> None:
        super().__init__(message)
        self.at_mm = at_mm
        self.handle = handle
        self.layer = layer
        self.nearest_mm = nearest_mm


class NothingFreeError(StartError):
    """The robot fits nowhere on this floor."""


class NoRouteError(StartError):
    """No way leads from the start to a pose that trowels a point.

    Attributes:
        at_mm: The point, in the drawing's axes in millimetres.
    """

    def __init__(self, message: str, *, at_mm: tuple[float, float]) -> None:
        super().__init__(message)
        self.at_mm = at_mm


class LimitError(SatAoiError, RuntimeError):
    """A stated limit was reached.

    Attributes:
        limit: Name of the limit.
        value: What the input asked for.
        allowed: What is allowed.
    """

    def __init__(self, message: str, *, limit: str, value: float, allowed: float) -> None:
        super().__init__(message)
        self.limit = limit
        self.value = value
        self.allowed = allowed
