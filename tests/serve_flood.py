#!/usr/bin/env python3
"""500 good clients of `tessera serve` while 1,000 bad ones drip: tests/serve_flood.py build/bin/tessera

Bad ones send a head's byte a second, nothing at all, heads without end, or bodies that nobody wants, or take a
large file at 40 KiB a second, and come again when they are sent away. Prints how many good clients were served and how fast, and the server's memory;
fails unless all were, below 100 MB."""
import asyncio
import os
import resource
import socket
import subprocess
import sys
import tempfile
import time

GOOD, BAD, BYTES = 500, 1000, 8192


async def drip(port, kind):
    if kind == 4:
        return await sip(port)
    say = {0: b"G", 1: b"", 2: b"X-a: " + b"x" * 90 + b"\r\n", 3: b"body"}[kind]
    start = {2: b"GET /a.tess HTTP/1.1\r\n",
             3: b"POST /a.tess HTTP/1.1\r\nContent-Length: 1000000000\r\n\r\n"}.get(kind, b"")
    while True:
        try:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(start)
            while not reader.at_eof():
                writer.write(say)
                await writer.drain()
                await asyncio.sleep(1)
            writer.close()
        except OSError:
            await asyncio.sleep(1)


async def sip(port):
    """Takes a file of 40 MB, 40 KiB a second."""
    loop = asyncio.get_running_loop()
    while True:
        with socket.socket() as connection:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.setblocking(False)
            try:
                await loop.sock_connect(connection, ("127.0.0.1", port))
                await loop.sock_sendall(connection, b"GET /large.tess HTTP/1.1\r\nHost: x\r\n\r\n")
                while await loop.sock_recv(connection, 4096):
                    await asyncio.sleep(0.1)
            except OSError:
                await asyncio.sleep(1)


async def fetch(port, content):
    """Seconds until the part has come, or None."""
    begin = time.monotonic()
    for _ in range(10):
        try:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"GET /a.tess HTTP/1.1\r\nHost: x\r\nRange: bytes=0-8191\r\nConnection: close\r\n\r\n")
            answer = await asyncio.wait_for(reader.read(), 30)
            writer.close()
            if answer.startswith(b"HTTP/1.1 206") and answer.endswith(content):
                return time.monotonic() - begin
        except (OSError, asyncio.TimeoutError):
            pass
        await asyncio.sleep(0.2)
    return None


async def flood(port, content):
    bad = [asyncio.create_task(drip(port, i % 5)) for i in range(BAD)]
    await asyncio.sleep(3)  # all of them are in
    times = await asyncio.gather(*(fetch(port, content) for _ in range(GOOD)))
    for task in bad:
        task.cancel()
    return times


def main():
    files = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(files, 8192), files))
    with tempfile.TemporaryDirectory() as folder:
        content = os.urandom(BYTES)
        with open(folder + "/a.tess", "wb") as file:
            file.write(content + bytes(100000))
        with open(folder + "/large.tess", "wb") as file:
            file.truncate(40_000_000)
        server = subprocess.Popen([sys.argv[1], "serve", folder, "--port", "0", "--quiet"],
                                  stdout=subprocess.PIPE, text=True)
        port = int(server.stdout.readline().rsplit(":", 1)[1].strip("/\n"))
        times = sorted(t for t in asyncio.run(flood(port, content)) if t is not None)
        status = open(f"/proc/{server.pid}/status").read()
        memory = int(status.split("VmHWM:")[1].split()[0]) / 1000
        server.terminate()
        begin = time.monotonic()
        code = server.wait()
        print(f"{len(times)} of {GOOD} good clients served beside {BAD} bad ones, "
              f"median {times[len(times) // 2]:.2f} s, slowest {times[-1]:.2f} s; {memory:.1f} MB; "
              f"ended {time.monotonic() - begin:.2f} s after SIGTERM with {code}" if times else "nobody served")
        return 0 if len(times) == GOOD and memory < 100 else 1


sys.exit(main())
