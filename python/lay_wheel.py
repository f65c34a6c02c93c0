#!/usr/bin/env python3
"""Lays the wheel of the Python package without any build tool.

    lay_wheel.py ROOT LIBRARY OUT

Writes OUT/tessera-VERSION-py3-none-PLATFORM.whl with the package ROOT/python/tessera, the library
and what ROOT/pyproject.toml says, and unpacks it to OUT/site. Needs Python 3.11.
"""
import base64
import hashlib
import pathlib
import shutil
import sys
import sysconfig
import tomllib
import zipfile


def metadata_of(project, readme):
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}",
             f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}",
             "Description-Content-Type: text/markdown"]
    lines += [f"Requires-Dist: {wanted}" for wanted in project["dependencies"]]
    for extra, packages in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}"]
        lines += [f"Requires-Dist: {wanted}; extra == '{extra}'" for wanted in packages]
    return "\n".join(lines) + "\n\n" + readme


def entry_points_of(project):
    groups = [f"[{group}]\n" + "".join(f"{name} = {target}\n" for name, target in entries.items())
              for group, entries in project["entry-points"].items()]
    return "\n".join(groups)


def checksum(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def lay(root, library, out):
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    name = f"{project['name']}-{project['version']}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    tag = f"py3-none-{platform}"
    package = root / "python" / "tessera"
    files = {f"tessera/{path.name}": path.read_bytes() for path in sorted(package.iterdir())
             if path.suffix == ".py" or path.name == "py.typed"}
    files[f"tessera/{library.name}"] = library.read_bytes()
    info = f"{name}.dist-info"
    readme = (root / project["readme"]).read_text()
    files[f"{info}/METADATA"] = metadata_of(project, readme).encode()
    files[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: tessera\nRoot-Is-Purelib: false\n"
                              f"Tag: {tag}\n").encode()
    files[f"{info}/entry_points.txt"] = entry_points_of(project).encode()
    record = f"{info}/RECORD"
    rows = [f"{path},sha256={checksum(data)},{len(data)}\n" for path, data in files.items()]
    files[record] = "".join(rows + [f"{record},,\n"]).encode()

    for old in out.glob(f"{project['name']}-*.whl"):
        old.unlink()
    wheel = out / f"{name}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)  # with a fixed date, so that the wheel is reproducible
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)
    shutil.rmtree(out / "site", ignore_errors=True)
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(out / "site")
    return wheel


print(lay(*map(pathlib.Path, sys.argv[1:])))
