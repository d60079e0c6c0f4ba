"""Makes the package's wheel for pip (PEP 517), with CMake and what Python has: it fetches nothing.

Settings of pip's --config-settings: build-dir=FOLDER, a CMake build of asperity with ASPERITY_BUILD_PYTHON to take or to
make (default: build/wheel of the sources); jobs=N for the compiler.
"""

import base64
import hashlib
import re
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

_here = Path(__file__).resolve().parent
_root = _here.parent.parent

_options = {
    "CMAKE_BUILD_TYPE": "Release",
    "ASPERITY_BUILD_PYTHON": "ON",
    "ASPERITY_BUILD_TESTS": "OFF",
    "ASPERITY_BUILD_EXAMPLES": "OFF",
    "ASPERITY_BUILD_GL": "OFF",
    "ASPERITY_BUILD_HAL": "OFF",
    "ASPERITY_INSTALL": "OFF",
}


def _version():
    header = _root / "include" / "asperity" / "version.hpp"
    found = re.search(r'define ASPERITY_VERSION_STRING "([0-9.]+)"', header.read_text())
    if not found:
        raise RuntimeError(f"{header} names no version of asperity")
    return found[1]


def _built(settings):
    """The folder of the package, built."""
    folder = Path(settings.get("build-dir") or _root / "build" / "wheel").resolve()
    if not (folder / "CMakeCache.txt").exists():
        options = [f"-D{name}={value}" for name, value in {**_options, "Python_EXECUTABLE": sys.executable}.items()]
        subprocess.run(["cmake", "-G", "Ninja", "-S", _root, "-B", folder, *options], check=True)
    jobs = ["--parallel", settings["jobs"]] if "jobs" in settings else []
    subprocess.run(["cmake", "--build", folder, "--target", "asperity_python", *jobs], check=True)
    return folder / "python" / "asperity"


def _metadata():
    return (
        "Metadata-Version: 2.1\n"
        "Name: asperity\n"
        f"Version: {_version()}\n"
        "Summary: What a hand feels when one textured object is pressed and scraped against another\n"
        "License: Apache-2.0\n"
        "Requires-Python: >=3.9\n"
        "Requires-Dist: numpy\n"
        'Provides-Extra: plot\n'
        'Requires-Dist: matplotlib; extra == "plot"\n'
    )


def _write_wheel(path, files, tag):
    """files: bytes by their name in the wheel. The same files give the same bytes."""
    info = f"asperity-{_version()}.dist-info"
    files = {
        **files,
        f"{info}/LICENSE": (_root / "LICENSE").read_bytes(),
        f"{info}/METADATA": _metadata().encode(),
        f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: asperity\nRoot-Is-Purelib: false\nTag: {tag}\n".encode(),
    }
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as to:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name)  # of 1980, whenever it is made
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            to.writestr(entry, content)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the package and returns the name of the wheel in wheel_directory."""
    package = _built(config_settings or {})
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    if not (package / f"_asperity{suffix}").exists():
        raise RuntimeError(f"{package} has no module for {sys.executable}: it was built for another Python")
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    taken = [p for p in sorted(package.iterdir()) if p.name == "py.typed" or p.suffix in (".py", ".pyi", ".so")]
    name = f"asperity-{_version()}-{tag}.whl"
    _write_wheel(Path(wheel_directory) / name, {f"asperity/{p.name}": p.read_bytes() for p in taken}, tag)
    return name
