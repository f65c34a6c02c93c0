"""Where the bytes of a .tess file come from: file objects and web servers."""
from __future__ import annotations

import base64
import bisect
import concurrent.futures
import ctypes as c
import http.client
import re
import threading
import urllib.error
import urllib.parse
import urllib.request
from typing import Any, BinaryIO, List, Sequence, Tuple

from . import _library as lib

FIRST_BYTES = 65536  # read from a server at opening: the head of most files
GAP = 16384          # ranges that are closer than this are one request
CONNECTIONS = 4


class FileObject:
    """A binary file object that can seek: open(), io.BytesIO, a member of a zip, fsspec."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.name = str(getattr(file, "name", type(file).__name__))
        try:
            self.size = file.seek(0, 2)
            if not isinstance(file.read(0), (bytes, bytearray, memoryview)):
                raise ValueError(f"{self.name}: the file object must be opened in binary mode")
        except AttributeError:
            raise TypeError("open() takes a path, a URL, bytes or a binary file object, not "
                            f"{type(file).__name__}") from None

    def read(self, offset: int, count: int) -> bytes:
        self._file.seek(offset)
        data = self._file.read(count)
        while len(data) < count:  # raw files may return less than asked for
            more = self._file.read(count - len(data))
            if not more:
                raise OSError(f"{self.name}: the file ended {count - len(data)} bytes early")
            data += more
        return data


class WebFile:
    """A file on an HTTP or HTTPS server that answers range requests.

    All responses must be of the version that was there at opening: the size, the ETag and the
    time of the last modification must be the same. User and password in the URL are sent to its
    host only, not where it redirects, and are left out of messages.
    """

    def __init__(self, url: str, timeout: float) -> None:
        parts = urllib.parse.urlsplit(url)
        self.name = parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()
        self._timeout, self._login = timeout, ""
        if parts.username is not None:
            login = f"{parts.username}:{parts.password or ''}"
            self._login = "Basic " + base64.b64encode(urllib.parse.unquote_to_bytes(login)).decode()
        self._start, self._version = self._get(0, FIRST_BYTES)
        self.size = self._version[0]

    def _get(self, offset: int, count: int) -> Tuple[bytes, Tuple[int, str, str]]:
        """Returns bytes of the file and its version; fewer than `count` bytes only at its end."""
        request = urllib.request.Request(
            self.name, headers={"Range": f"bytes={offset}-{offset + count - 1}"})
        if self._login:
            request.add_unredirected_header("Authorization", self._login)
        try:
            with urllib.request.urlopen(request, timeout=self._timeout) as response:
                place = re.fullmatch(r"bytes (\d+)-(\d+)/(\d+)",
                                     response.headers.get("Content-Range", ""))
                if response.status != 206 or place is None:
                    raise OSError(f"{self.name}: the server does not answer range requests; "
                                  "download the file first")
                size = int(place[3])
                data = response.read(count + 1)
                if int(place[1]) != offset or len(data) != min(count, size - offset):
                    raise OSError(f"{self.name}: the server sent other bytes than those from "
                                  f"{offset} to {offset + count}")
                return data, (size, response.headers.get("ETag", ""),
                              response.headers.get("Last-Modified", ""))
        except urllib.error.HTTPError as error:
            raise OSError(f"{self.name}: the server answers {error.code} {error.reason}") from None
        except urllib.error.URLError as error:
            raise OSError(f"{self.name}: {error.reason}") from None
        except http.client.HTTPException as error:
            raise OSError(f"{self.name}: the server's answer is not HTTP: {error!r}") from None
        except TimeoutError:
            raise OSError(f"{self.name}: no answer within {self._timeout} seconds") from None

    def read(self, offset: int, count: int) -> bytes:
        if offset + count <= len(self._start):
            return self._start[offset:offset + count]
        data, version = self._get(offset, count)
        if version != self._version:
            raise OSError(f"{self.name}: the file on the server has changed since it was opened")
        return data

    def read_many(self, ranges: Sequence[Tuple[int, int]]) -> List[memoryview]:
        """Reads ranges of (offset, count), the near ones with one request, several at a time."""
        spans: List[Tuple[int, int]] = []
        for offset, count in sorted(ranges):
            if spans and offset <= spans[-1][1] + GAP:
                spans[-1] = (spans[-1][0], max(spans[-1][1], offset + count))
            else:
                spans.append((offset, offset + count))
        with concurrent.futures.ThreadPoolExecutor(CONNECTIONS) as pool:
            data = list(pool.map(lambda span: self.read(span[0], span[1] - span[0]), spans))
        begins = [begin for begin, _ in spans]
        found = []
        for offset, count in ranges:
            i = bisect.bisect_right(begins, offset) - 1
            found.append(memoryview(data[i])[offset - begins[i]:][:count])
        return found


class CallbackSource:
    """A tessera_byte_source that reads from `file`, and the exceptions that this raises.

    An exception gets a number, with which the library's function fails, so that the exception
    continues in the right call although the library reads on threads of its own.
    """

    KEPT = 64

    def __init__(self, file: Any) -> None:
        self._file, self._raised, self._lock = file, {}, threading.Lock()
        self._next = lib.CALLBACK_FAILED + 1
        many = hasattr(file, "read_many")
        self.c_source = lib.ByteSource(
            size=file.size, name=file.name.replace("\0", "").encode("utf-8", "replace"),
            read=lib.ReadFunction(self._read), one_at_a_time=not many, slow=many)
        if many:
            self.c_source.read_many = lib.ReadManyFunction(self._read_many)

    def _read(self, user: Any, offset: int, out: int, count: int) -> int:
        try:
            self._copy(self._file.read(offset, count), out, count)
            return 0
        except BaseException as error:  # of any kind: it continues in raise_for()
            return self._keep(error)

    def _read_many(self, user: Any, ranges: Any, count: int) -> int:
        try:
            wanted = [(ranges[i].offset, ranges[i].bytes) for i in range(count)]
            for i, data in enumerate(self._file.read_many(wanted)):
                self._copy(data, ranges[i].out, ranges[i].bytes)
            return 0
        except BaseException as error:
            return self._keep(error)

    def _copy(self, data: Any, out: int, count: int) -> None:
        if len(data) != count:
            raise OSError(f"{self._file.name}: {len(data)} bytes were read instead of {count}")
        c.memmove(out, bytes(data), count)

    def _keep(self, error: BaseException) -> int:
        with self._lock:
            self._next += 1
            self._raised[self._next] = error
            self._raised.pop(self._next - self.KEPT, None)
            return self._next

    def raise_for(self, code: int) -> None:
        """Raises the exception that made a function of the library fail with `code`, if any."""
        with self._lock:
            error = self._raised.pop(code, None)
        if error is not None:
            raise error
