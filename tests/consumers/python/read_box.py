#!/usr/bin/env python3
"""Reads a box of a .tess file through the shared library and writes one picture per direction.

    read_box.py LIBRARY FILE.tess OUTPUT [u0:u1,v0:v1,s0:s1,t0:t1]

Writes OUTPUT-s-t.pgm or .ppm. The default box is the whole picture of the middle direction.
"""
import ctypes as c
import sys

Extent = c.c_uint32 * 4


class Texture(c.Structure):  # tessera_texture
    _fields_ = [("size", Extent), ("type", c.c_int32), ("channels", c.c_uint32)]


def load(path):  # an error of a function ends the script
    library = c.CDLL(path)
    library.tessera_last_error.restype = library.tessera_error_name.restype = c.c_char_p
    library.tessera_close.argtypes, library.tessera_close.restype = [c.c_void_p], None

    def check(error, function, arguments):
        if error != 0:
            name, sentence = library.tessera_error_name(error), library.tessera_last_error()
            sys.exit(name.decode() + ": " + sentence.decode())
    for name, *types in (
            ("open_path", c.c_char_p, c.c_void_p, c.POINTER(c.c_void_p)),
            ("get_texture", c.c_void_p, c.POINTER(Texture)),
            ("box_bytes", c.POINTER(Texture), Extent, Extent, c.POINTER(c.c_uint64)),
            ("decode_box", c.c_void_p, Extent, Extent, c.c_void_p, c.c_size_t, c.c_void_p)):
        function = getattr(library, "tessera_" + name)
        function.argtypes, function.errcheck = types, check
    return library


def main(library, path, output, box=None):
    tessera, decoder, texture, count = load(library), c.c_void_p(), Texture(), c.c_uint64()
    tessera.tessera_open_path(path.encode(), None, c.byref(decoder))
    tessera.tessera_get_texture(decoder, c.byref(texture))
    u, v, s, t = texture.size
    if texture.type != 0 or texture.channels not in (1, 3):
        sys.exit("%s: neither grey nor RGB of 8 bits, which is all that PNM holds" % path)
    box = box or "0:%d,0:%d,%d:%d,%d:%d" % (u, v, s // 2, s // 2 + 1, t // 2, t // 2 + 1)
    begin, end = (Extent(*side) for side in zip(*(map(int, a.split(":")) for a in box.split(","))))
    tessera.tessera_box_bytes(c.byref(texture), begin, end, c.byref(count))
    texels = (c.c_ubyte * count.value)()
    tessera.tessera_decode_box(decoder, begin, end, texels, count.value, None)
    tessera.tessera_close(decoder)
    n, (width, height, ns, nt) = texture.channels, (e - b for b, e in zip(begin, end))
    for view in range(ns * nt):  # texels are in the order v, u, t, s; s is fastest
        pixels = bytearray(width * height * n)
        for channel in range(n):
            pixels[channel::n] = bytes(texels[view * n + channel::ns * nt * n])
        place = begin[2] + view % ns, begin[3] + view // ns, "pgm" if n == 1 else "ppm"
        with open("%s-%d-%d.%s" % ((output,) + place), "wb") as picture:
            picture.write(b"P%d %d %d 255\n" % (5 if n == 1 else 6, width, height) + pixels)


main(*sys.argv[1:])
