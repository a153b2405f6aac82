from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from types import TracebackType
from typing import Any, Literal, NamedTuple, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Answer", "Atlas", "Figure", "Frame", "Model", "Outline", "Picture", "Recording", "Sensor", "Watch",
    "describe", "load", "read", "threshold", "train", "watch",
]

_Path = Union[str, PathLike[str]]
_Range = Union[str, float]
_Shape = Union[Figure, Picture, Outline]
_Ring = Union[Sequence[tuple[float, float]], NDArray[Any], Mapping[str, float]]
_Region = dict[str, Any]

class Sensor:
    columns: int
    rows: int
    threshold: float
    pitch: Optional[float]
    def __new__(cls, columns: int = 16, rows: int = 16, threshold: float = 0.5, pitch: Optional[float] = None) -> Sensor: ...
    def touch(
        self, shape: _Shape, *, x0: ArrayLike = ..., y0: ArrayLike = ..., angle: ArrayLike = ..., zoom_x: ArrayLike = ...,
        zoom_y: ArrayLike = ..., **sizes: ArrayLike,
    ) -> NDArray[np.bool_]: ...
    def coverage(
        self, shape: _Shape, *, x0: ArrayLike = ..., y0: ArrayLike = ..., angle: ArrayLike = ..., zoom_x: ArrayLike = ...,
        zoom_y: ArrayLike = ..., **sizes: ArrayLike,
    ) -> NDArray[np.float64]: ...
    def sweep(
        self, shape: _Shape, *, x0: Optional[_Range] = None, y0: Optional[_Range] = None, angle: Optional[_Range] = None,
        zoom_x: Optional[_Range] = None, zoom_y: Optional[_Range] = None, anchor: Literal["corner", "centre"] = "corner",
    ) -> Atlas: ...

class Figure:
    kind: str
    def __getattr__(self, size: str) -> float: ...
    def __new__(
        cls, kind: Literal["ellipse", "rectangle", "triangle", "pentagon", "hexagon", "heptagon", "octagon"], *,
        radius_x: float = ..., radius_y: float = ..., length: float = ..., width: float = ..., side: float = ...,
        thickness: float = ...,
    ) -> Figure: ...

class Picture:
    mask: NDArray[np.bool_]
    def __new__(cls, mask: NDArray[np.bool_]) -> Picture: ...

class Outline:
    rings: Sequence[_Ring]
    pitch: Optional[float]
    name: str
    def __new__(cls, rings: Sequence[_Ring], pitch: Optional[float] = None, name: str = "outline") -> Outline: ...
    @classmethod
    def read(
        cls, path: _Path, *, pitch: Optional[float] = None, mm_per_unit: Optional[float] = None, y_up: bool = False,
        flatness: float = 0.001,
    ) -> Outline: ...

@overload
def describe(imprint: NDArray[np.bool_]) -> list[_Region]: ...
@overload
def describe(imprint: Sequence[NDArray[np.bool_]]) -> list[list[_Region]]: ...

class Atlas:
    @property
    def imprints(self) -> NDArray[np.bool_]: ...
    @property
    def counts(self) -> NDArray[np.uint64]: ...
    @property
    def descriptors(self) -> dict[str, NDArray[np.float64]]: ...
    def statistics(self) -> dict[str, dict[str, Optional[float]]]: ...
    def save(self, path: _Path) -> None: ...

class Recording(NamedTuple):
    frames: NDArray[np.float64]
    times: Optional[NDArray[np.float64]]
    labels: Optional[list[Union[int, str, None]]]
    channel: Optional[str]
    unit: Optional[str]
    pitch: Optional[tuple[float, float]]
    threshold: Optional[float]

def read(
    path: _Path, *, channel: Optional[str] = None, rows: Optional[int] = None, columns: Optional[int] = None,
    time_column: Optional[str] = None, label_column: Optional[str] = None,
) -> Recording: ...
def threshold(
    frames: ArrayLike, *, at_least: Optional[float] = None, percent: Optional[float] = None, low: Optional[float] = None,
    high: Optional[float] = None, deviations: Optional[float] = None, least: int = 0, tare: Optional[ArrayLike] = None,
) -> NDArray[np.bool_]: ...

class Frame(NamedTuple):
    values: NDArray[np.float64]
    time: Optional[float]
    number: int
    label: Union[int, str, None]

class Watch(Iterator[Frame]):
    source: _Path
    @property
    def dropped(self) -> int: ...
    def close(self) -> None: ...
    def __next__(self) -> Frame: ...
    def __enter__(self) -> Watch: ...
    def __exit__(
        self, kind: Optional[type[BaseException]], value: Optional[BaseException], trace: Optional[TracebackType],
    ) -> None: ...

def watch(
    source: _Path, *, baud: Optional[int] = None, format: Optional[str] = None, rows: Optional[int] = None,
    columns: Optional[int] = None, channel: Optional[str] = None, time_column: Optional[str] = None,
    label_column: Optional[str] = None, once: bool = False,
) -> Watch: ...
def train(
    shapes: Union[Mapping[str, _Shape], Iterable[_Shape]], sensor: Optional[Sensor] = None, *, x0: Optional[_Range] = None,
    y0: Optional[_Range] = None, angle: Optional[_Range] = None, zoom_x: Optional[_Range] = None,
    zoom_y: Optional[_Range] = None, anchor: Optional[Literal["corner", "centre"]] = None, positions: int = 100,
    weights: Optional[Mapping[str, int]] = None, allow_cut: bool = False,
) -> Model: ...
def load(path: _Path) -> Any: ...

class Model:
    labels: list[str]
    sensor: Sensor
    @property
    def error(self) -> float: ...
    def confusion(self) -> NDArray[np.uint64]: ...
    @overload
    def recognise(
        self, imprint: NDArray[np.bool_], *, noise: Optional[float] = None, dead: Optional[NDArray[np.bool_]] = None,
        tolerance: Optional[int] = None, reject: Optional[float] = None,
    ) -> Answer: ...
    @overload
    def recognise(
        self, imprint: Sequence[NDArray[np.bool_]], *, noise: Optional[float] = None, dead: Optional[NDArray[np.bool_]] = None,
        tolerance: Optional[int] = None, reject: Optional[float] = None,
    ) -> list[Answer]: ...
    def separate(
        self, *, scale: Optional[_Range] = None, pitch: Optional[_Range] = None, threshold: Optional[float] = None,
    ) -> list[dict[str, Any]]: ...
    def save(self, path: _Path) -> None: ...

class Answer(NamedTuple):
    name: Optional[str]
    state: Literal["certain", "likely", "tied", "rejected", "unknown"]
    ranking: list[tuple[str, float]]
    fit: Optional[str]
    differs: Optional[int]
    pose: Optional[dict[str, float]]
    tied: list[str]
    at_rim: bool
