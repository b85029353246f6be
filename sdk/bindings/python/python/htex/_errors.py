"""The exceptions of the package.

If the operating system reports an error for a file, the package raises an ``OSError`` instead, such
as ``FileNotFoundError``.
"""


class Error(Exception):
    """An error of this package."""


class AssetError(Error):
    """A file is not a valid asset, or an asset breaks a rule of the format."""


class BuildError(Error):
    """A recipe is invalid, or a library cannot be built from it."""


class DeviceError(Error):
    """A device or its driver is missing, is in use, or failed. The device is then at rest."""


class ExchangeError(Error):
    """A file to import is not valid in its format, or a texture cannot be exported to a format."""


class LibraryError(Error):
    """A file is not a valid library, or a texture cannot be packed into a library."""


class ModelError(Error):
    """A model is missing, cannot be loaded, or failed."""


class MotionError(Error, ValueError):
    """A speed, force or position is out of range or not finite."""


class OptionError(Error, ValueError):
    """An argument is out of range or unknown."""


class RecordingError(Error):
    """A recording cannot be read, or contains no usable texture signal."""


class SceneError(Error):
    """A scene is invalid, or cannot be planned or played."""


class SignatureError(Error):
    """A file is not signed by a key in ``only_signed_by``."""


for _class in (
    Error,
    AssetError,
    BuildError,
    DeviceError,
    ExchangeError,
    LibraryError,
    ModelError,
    MotionError,
    OptionError,
    RecordingError,
    SceneError,
    SignatureError,
):
    _class.__module__ = "htex"
