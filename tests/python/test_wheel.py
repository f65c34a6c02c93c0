"""The wheel, its library, and the Python declarations beside tessera.h."""
import base64
import ctypes
import hashlib
import importlib.metadata
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile

import pytest
from conftest import ROOT

import tessera
from tessera import _description, _library

SITE = pathlib.Path(tessera.__file__).parents[1]
LIBRARY = SITE / "tessera" / "libtessera.so"
needs_wheel = pytest.mark.skipif(SITE.name != "site", reason="the package is not a laid wheel")
needs_objdump = pytest.mark.skipif(shutil.which("objdump") is None, reason="needs binutils")

# Symbols of glibc newer than 2.28 that the library may need. glibc 2.28 has all of them under an
# older version, which the library needs instead if it is built there; only those in `static_only`
# come from libgcc and libstdc++ of the compiler and vanish there.
moved = set("""exp exp2 fstat fstat64 hypot log log2 lstat pow pthread_create pthread_detach
    pthread_getspecific pthread_join pthread_key_create __pthread_key_create pthread_key_delete
    pthread_once pthread_rwlock_rdlock pthread_rwlock_unlock pthread_rwlock_wrlock
    pthread_setspecific stat""".split())
static_only = {"__libc_single_threaded", "_dl_find_object"}


@needs_wheel
def test_wheel_is_well_formed():
    wheel, = SITE.parent.glob("tessera-*-py3-none-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        record, = (name for name in names if name.endswith("/RECORD"))
        rows = [row.split(",") for row in archive.read(record).decode().splitlines()]
        assert [row[0] for row in rows] == names
        for name, checksum, size in rows[:-1]:
            data = archive.read(name)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            assert (checksum, size) == ("sha256=" + digest, str(len(data)))
            assert (SITE / name).read_bytes() == data
    sources = {f"tessera/{path.name}" for path in (ROOT / "python" / "tessera").iterdir()
               if path.is_file()}
    assert {name for name in names if name.startswith("tessera/")} == \
        sources | {"tessera/libtessera.so"}
    assert wheel.stat().st_size < 4 << 20


@needs_wheel
def test_metadata():
    found = importlib.metadata.distribution("tessera")
    assert found.version == tessera.__version__
    assert found.metadata["Requires-Python"] == ">=3.9"
    assert "numpy>=1.20" in found.requires
    entry, = (e for e in found.entry_points if e.group == "numcodecs.codecs")
    assert entry.value == "tessera.numcodecs:Tessera"


@needs_wheel
@pytest.mark.skipif(importlib.util.find_spec("pip") is None, reason="needs pip")
def test_pip_installs_the_wheel(tmp_path):
    wheel, = SITE.parent.glob("tessera-*.whl")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--no-index",
           "--no-deps", "--no-compile", "--quiet", "--target", tmp_path, wheel]
    subprocess.run(pip, check=True)
    code = ("import numpy, tessera; a = numpy.arange(768, dtype='u1').reshape(8, 8, 2, 2, 3);"
            "t = tessera.open(tessera.encode_bytes(a, lossless=True, effort=0));"
            "print(tessera.__file__, (t[...] == a).all())")
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(tmp_path)}, cwd=tmp_path).stdout
    assert said.split() == [str(tmp_path / "tessera" / "__init__.py"), "True"]


# scikit-build-core, which `pip wheel .` runs, configures CMake with these definitions, builds these
# targets and installs these components beside the packages.
@needs_wheel
@pytest.mark.skipif(shutil.which("cmake") is None, reason="needs cmake")
def test_pyproject_names_what_cmake_has(tmp_path):
    build = SITE.parents[1]
    tool = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["scikit-build"]
    cache = (build / "CMakeCache.txt").read_text()
    for name in tool["cmake"]["define"]:
        assert re.search(rf"^{name}:(BOOL|STRING)=", cache, re.M) or name.startswith("CMAKE_"), name
    for target in tool["build"]["targets"]:
        subprocess.run(["cmake", "--build", build, "--target", target, "--", "-n"], check=True,
                       capture_output=True)
    for component in tool["install"]["components"]:
        subprocess.run(["cmake", "--install", build, "--component", component, "--prefix", tmp_path],
                       check=True, capture_output=True)
    for package in tool["wheel"]["packages"]:
        shutil.copytree(ROOT / package, tmp_path / pathlib.Path(package).name, dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns("__pycache__"))
    installed = {path.name for path in (tmp_path / "tessera").iterdir()}
    assert {path.name for path in tmp_path.iterdir()} == {"tessera"}
    assert installed == {path.name for path in (SITE / "tessera").iterdir()} - {"__pycache__"}


def symbols(*options):
    return subprocess.run(["objdump", "-T", *options, LIBRARY], check=True, capture_output=True,
                          text=True).stdout.splitlines()


@needs_wheel
@needs_objdump
def test_library_exports_the_c_interface_only():
    exported = {line.split()[-1] for line in symbols() if "*UND*" not in line and " g " in line}
    header = (ROOT / "codec" / "tessera.h").read_text()
    assert exported == set(re.findall(r"^TESSERA_API .*?(tessera_\w+)\(", header, re.M))


@needs_wheel
@needs_objdump
def test_library_needs_no_new_glibc():
    newer = set()
    for line in symbols():
        found = re.search(r"\(GLIBC_2\.(\d+)[\d.]*\)\s+(\w+)$", line)
        if found and int(found[1]) > 28:
            newer.add(found[2])
    print("newer than glibc 2.28:", *sorted(newer))
    assert newer <= moved | static_only
    needed = subprocess.run(["objdump", "-p", LIBRARY], check=True, capture_output=True,
                            text=True).stdout
    assert set(re.findall(r"NEEDED +([a-z-]+)", needed)) <= {"libm", "libc", "ld-linux-x"}


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_structures_are_those_of_the_header(tmp_path):
    checks = []
    for name in dir(_library):
        kind = getattr(_library, name)
        if not (isinstance(kind, type) and issubclass(kind, ctypes.Structure)) or \
                kind in (_library.Sized, ctypes.Structure):
            continue
        c_name = getattr(kind, "c_name", "tessera" + re.sub("([A-Z])", r"_\1", name).lower())
        checks.append(f"_Static_assert(sizeof({c_name}) == {ctypes.sizeof(kind)}, \"{c_name}\");")
        checks += [f"_Static_assert(offsetof({c_name}, {field}) == {getattr(kind, field).offset}, "
                   f"\"{c_name}.{field}\");" for field, _ in kind._fields_]
    assert len(checks) > 100
    source = tmp_path / "check.c"
    source.write_text('#include "codec/tessera.h"\n' + "\n".join(checks))
    subprocess.run(["cc", "-fsyntax-only", f"-I{ROOT}", source], check=True)
    header = (ROOT / "codec" / "tessera.h").read_text()
    assert f"#define TESSERA_API_VERSION {_library.API_VERSION}\n" in header


def test_names_are_those_of_the_library():
    header = (ROOT / "format" / "metadata.h").read_text()
    lists = re.findall(r"value_names<(\w+)>\{([^}]*)\}", header)
    names = {kind: tuple(re.findall(r'"([^"]*)"', text)) for kind, text in lists}
    assert names == {"Proxy": _description.NAMES["proxy"],
                     "SurfaceMap": _description.NAMES["surface_map"],
                     "AngularMap": _description.NAMES["angular_map"],
                     "Transfer": _description.NAMES["transfer"],
                     "Primaries": _description.NAMES["primaries"],
                     "AlphaMode": _description.NAMES["alpha"]}


def test_other_libraries_are_refused(tmp_path):
    def import_with(path):
        return subprocess.run(
            [sys.executable, "-c", "import tessera"],
            env={**os.environ, "TESSERA_LIBRARY": str(path)}, capture_output=True, text=True).stderr

    assert "ImportError: Tessera's library cannot be loaded: " in import_with(tmp_path / "none.so")
    assert "TESSERA_LIBRARY" in import_with("libm.so.6")
