# SPDX-License-Identifier: Apache-2.0
"""The PEP 517 back end: CMake builds package and program, and this file zips them as a wheel.

The build folder is build/wheel, or another one: pip install . --config-settings build-dir=FOLDER.
Nothing is downloaded; what is needed is in scripts/packages.txt and scripts/packages-python.txt.
"""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def _read(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read()


def _version():
    return re.search(r"project\(lucerna VERSION ([0-9.]+)", _read("CMakeLists.txt"))[1]


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _metadata():
    project = tomllib.loads(_read("pyproject.toml"))["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {need}" for need in project["dependencies"]]
    for extra, needs in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {need}; extra == '{extra}'" for need in needs)]
    return "\n".join([*lines, "Description-Content-Type: text/markdown", "", _read("README.md")])


def _wheel_text():
    return f"Wheel-Version: 1.0\nGenerator: lucerna_build\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def _cmake(folder):
    def run(*arguments):
        subprocess.run(["cmake", *arguments], check=True)

    generator = [] if os.path.exists(os.path.join(folder, "CMakeCache.txt")) else ["-G", "Ninja"]
    run("-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DLUCERNA_PYTHON=ON",
        "-DLUCERNA_BUILD_TESTS=OFF", "-DLUCERNA_BUILD_BENCHMARKS=OFF", "-DLUCERNA_SHARED=OFF",
        f"-DPython3_EXECUTABLE={sys.executable}", *os.environ.get("CMAKE_ARGS", "").split())
    run("--build", folder, "--target", "python_package", "lucerna_cli")


def _built_files(folder):
    """Names in the wheel and the files that were built for them."""
    package = os.path.join(folder, "python", "lucerna")
    for name in sorted(os.listdir(package)):
        if name.endswith((".py", ".pyi", ".so", ".typed")):
            yield f"lucerna/{name}", os.path.join(package, name)
    yield f"lucerna-{_version()}.data/scripts/lucerna", os.path.join(folder, "lucerna")


class _Wheel:
    def __init__(self, path):
        self.zip, self.record = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED), []

    def add(self, name, data, mode=0o644):
        info = zipfile.ZipInfo(name)  # 1980, so that the same files make the same wheel
        info.external_attr = (0o100000 | mode) << 16
        info.compress_type = zipfile.ZIP_DEFLATED
        self.zip.writestr(info, data)
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(data)}\n")

    def close(self, info):
        name = f"{info}/RECORD"
        self.zip.writestr(zipfile.ZipInfo(name), "".join([*self.record, f"{name},,\n"]))
        self.zip.close()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = os.path.join(ROOT, (config_settings or {}).get("build-dir", os.path.join("build", "wheel")))
    _cmake(folder)
    name = f"lucerna-{_version()}-{_tag()}.whl"
    info = f"lucerna-{_version()}.dist-info"
    wheel = _Wheel(os.path.join(wheel_directory, name))
    for inside, path in _built_files(folder):
        with open(path, "rb") as file:
            wheel.add(inside, file.read(), 0o755 if "/scripts/" in inside else 0o644)
    for file, text in (("METADATA", _metadata()), ("WHEEL", _wheel_text()), ("LICENSE", _read("LICENSE"))):
        wheel.add(f"{info}/{file}", text.encode())
    wheel.close(info)
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = f"lucerna-{_version()}.dist-info"
    os.makedirs(os.path.join(metadata_directory, info))
    for file, text in (("METADATA", _metadata()), ("WHEEL", _wheel_text())):
        with open(os.path.join(metadata_directory, info, file), "w", encoding="utf-8") as out:
            out.write(text)
    return info


def build_sdist(sdist_directory, config_settings=None):
    base = f"lucerna-{_version()}"
    files = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True).stdout
    metadata = os.path.join(sdist_directory, "PKG-INFO")
    with open(metadata, "w", encoding="utf-8") as out:
        out.write(_metadata())
    with tarfile.open(os.path.join(sdist_directory, f"{base}.tar.gz"), "w:gz", format=tarfile.PAX_FORMAT) as tar:
        for name in files.decode().split("\0")[:-1]:
            tar.add(os.path.join(ROOT, name), f"{base}/{name}", recursive=False)
        tar.add(metadata, f"{base}/PKG-INFO")
    os.unlink(metadata)
    return f"{base}.tar.gz"
